// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "shape_argument.h"

namespace iota::bindings {

namespace {

constexpr const char* mesh_doc =
    "What a closed surface of triangles encloses. vertices: (n, 3), m. triangles: (k, 3) numbers of vertices, from outside\n"
    "counter-clockwise. Raises ValueError where the surface is open, inside out, flat, inconsistently wound or names\n"
    "vertices that are not there; the text says which triangle or edge.\n\n"
    "    iota.Mesh.load('part.stl')         # any format that trimesh reads, where it is installed\n"
    "    iota.Mesh.convex_hull(points)      # the skin round loose points";

std::string text_of(const char* format, auto... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

nb::object array_of(nb::handle values, const char* dtype, const char* name) {
  nb::object array = nb::module_::import_("numpy").attr("ascontiguousarray")(values, dtype);
  if (nb::cast<int>(array.attr("ndim")) != 2 || nb::cast<int>(array.attr("shape")[nb::int_(1)]) != 3) {
    const std::string text =
        std::string(name) + " must have the shape (n, 3), not " + nb::repr(array.attr("shape")).c_str();
    throw nb::value_error(text.c_str());
  }
  return array;
}

Mesh make_mesh(nb::handle vertices, nb::handle triangles) {
  const nb::object places = array_of(vertices, "float64", "vertices"),
                   faces = array_of(triangles, "int64", "triangles");
  const auto x = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(places);
  const auto t = nb::cast<nb::ndarray<const std::int64_t, nb::c_contig, nb::device::cpu>>(faces);
  Mesh mesh;
  for (std::size_t i = 0; i < x.shape(0); ++i)
    mesh.vertices.push_back({x.data()[3 * i], x.data()[3 * i + 1], x.data()[3 * i + 2]});
  for (std::size_t i = 0; i < t.shape(0); ++i) {
    auto& triangle = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t vertex = t.data()[3 * i + k];
      // What is out of range becomes a number that the engine refuses by name.
      triangle[k] = vertex < 0 || vertex > 0xffffffff ? 0xffffffffu : static_cast<std::uint32_t>(vertex);
    }
  }
  return mesh;
}

nb::object matrix(const Matrix3& rows) {
  std::vector<double> numbers;
  for (const Vec3& row : rows) numbers.insert(numbers.end(), {row.x, row.y, row.z});
  return nb::cast(make_vector3_array(std::move(numbers)));
}

template <class S>
void def_common(nb::class_<S>& type) {
  type.def_prop_ro(
      "mass_properties", [](const S& s) { return mass_properties(s); },
      "Volume, center and second moments. Raises ValueError for sizes that are not positive.");
}

}  // namespace

Shape to_shape(nb::handle value) {
  Shape shape;
  const auto is = [&]<class S>(S*) {
    if (!nb::isinstance<S>(value)) return false;
    shape = nb::cast<S>(value);
    return true;
  };
  if (is(static_cast<Sphere*>(nullptr)) || is(static_cast<Box*>(nullptr)) || is(static_cast<Cylinder*>(nullptr)) ||
      is(static_cast<Capsule*>(nullptr)) || is(static_cast<Torus*>(nullptr)) || is(static_cast<Mesh*>(nullptr)))
    return shape;
  const std::string text = "shape must be a Sphere, Box, Cylinder, Capsule, Torus or Mesh, not " + describe(value);
  throw nb::type_error(text.c_str());
}

nb::object from_shape(const Shape& shape) {
  return std::visit([](const auto& s) { return nb::cast(s); }, shape);
}

void bind_shapes(nb::module_& module) {
  nb::class_<MassProperties>(module, "MassProperties", "Of a homogeneous solid, in its own frame.")
      .def_ro("volume", &MassProperties::volume, "m^3")
      .def_ro("center", &MassProperties::center, "Of mass, m.")
      .def_prop_ro(
          "mean_squares", [](const MassProperties& p) { return matrix(p.mean_squares); },
          nb::sig("def mean_squares(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Mean of r r' over the volume, r from the center, m^2: inertia = mass (trace I - this).");

  nb::class_<Sphere> sphere(module, "Sphere", "A ball. radius: m.");
  sphere
      .def(
          "__init__", [](Sphere* self, double radius) { new (self) Sphere{finite_positive(radius, "radius", "m")}; },
          "radius"_a)
      .def_ro("radius", &Sphere::radius)
      .def("__repr__", [](const Sphere& s) { return text_of("Sphere(%g)", s.radius); });
  def_common(sphere);

  nb::class_<Box> box(module, "Box", "A box with edges `size` along x, y, z, m; its origin is its middle.");
  box.def(
         "__init__",
         [](Box* self, VectorArgument size) {
           const Vec3 edges = to_vec3(size, "size");
           for (const double edge : {edges.x, edges.y, edges.z}) finite_positive(edge, "each edge", "m");
           new (self) Box{edges};
         },
         "size"_a)
      .def_ro("size", &Box::size)
      .def("__repr__", [](const Box& b) { return text_of("Box((%g, %g, %g))", b.size.x, b.size.y, b.size.z); });
  def_common(box);

  const auto bind_rod = [&]<class S>(S*, const char* name, const char* doc) {
    nb::class_<S> type(module, name, doc);
    type.def(
            "__init__",
            [](S* self, double radius, double length) {
              new (self) S{finite_positive(radius, "radius", "m"), finite_positive(length, "length", "m")};
            },
            "radius"_a, "length"_a)
        .def_ro("radius", &S::radius)
        .def_ro("length", &S::length)
        .def("__repr__", [name](const S& s) { return text_of("%s(%g, %g)", name, s.radius, s.length); });
    def_common(type);
  };
  bind_rod(static_cast<Cylinder*>(nullptr), "Cylinder", "Along x, from -length/2 to +length/2, m.");
  bind_rod(static_cast<Capsule*>(nullptr), "Capsule",
           "A cylinder along x with half spheres at its ends; `length` is that of the cylinder, m.");

  nb::class_<Torus> torus(module, "Torus", "A ring in the x-y plane: center line `radius`, wire radius `tube`, m.");
  torus
      .def(
          "__init__",
          [](Torus* self, double radius, double tube) {
            new (self) Torus{finite_positive(radius, "radius", "m"), finite_positive(tube, "tube", "m")};
          },
          "radius"_a, "tube"_a)
      .def_ro("radius", &Torus::radius)
      .def_ro("tube", &Torus::tube)
      .def("__repr__", [](const Torus& t) { return text_of("Torus(%g, %g)", t.radius, t.tube); });
  def_common(torus);

  nb::class_<Mesh> mesh(module, "Mesh", mesh_doc);
  mesh.def(
          "__init__",
          [](Mesh* self, nb::object vertices, nb::object triangles) {
            Mesh made = make_mesh(vertices, triangles);
            (void)mass_properties(made);  // refuses what is no closed surface
            new (self) Mesh(std::move(made));
          },
          "vertices"_a, "triangles"_a,
          nb::sig("def __init__(self, vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike) -> None"))
      .def_static(
          "load",
          [](nb::object path) {
            nb::object loaded = nb::module_::import_("trimesh").attr("load")(path, "force"_a = "mesh");
            Mesh made = make_mesh(loaded.attr("vertices"), loaded.attr("faces"));
            (void)mass_properties(made);
            return made;
          },
          "path"_a, nb::sig("def load(path: str | os.PathLike[str]) -> Mesh"),
          "Reads a file of any format that trimesh knows. Raises ImportError without trimesh.")
      .def_static(
          "convex_hull",
          [](nb::handle points) {
            const nb::object places = array_of(points, "float64", "points");
            const auto x = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(places);
            static_assert(sizeof(Vec3) == 3 * sizeof(double));
            return convex_hull({reinterpret_cast<const Vec3*>(x.data()), x.shape(0)});
          },
          "points"_a, nb::sig("def convex_hull(points: numpy.typing.ArrayLike) -> Mesh"),
          "The skin round loose points, (n, 3), m: points within it, on its faces and given twice do no harm. Raises\n"
          "ValueError for fewer than four, for what is not finite, and where all are in one plane or on one line.")
      .def_prop_ro(
          "vertices",
          [](const Mesh& m) {
            std::vector<double> numbers;
            for (const Vec3& v : m.vertices) numbers.insert(numbers.end(), {v.x, v.y, v.z});
            return make_vector3_array(std::move(numbers));
          },
          nb::rv_policy::move, "(n, 3), m")
      .def_prop_ro(
          "triangles",
          [](const Mesh& m) {
            auto* numbers = new std::uint32_t[3 * m.triangles.size()];
            for (std::size_t i = 0; i < m.triangles.size(); ++i) std::copy_n(m.triangles[i].data(), 3, numbers + 3 * i);
            nb::capsule owner(numbers, [](void* p) noexcept { delete[] static_cast<std::uint32_t*>(p); });
            return nb::ndarray<nb::numpy, std::uint32_t, nb::shape<-1, 3>>(numbers, {m.triangles.size(), 3}, owner);
          },
          nb::rv_policy::move, "(k, 3)")
      .def("__repr__", [](const Mesh& m) {
        return text_of("<Mesh: %zu vertices, %zu triangles>", m.vertices.size(), m.triangles.size());
      });
  def_common(mesh);

  nb::class_<SolidView>(module, "Solid", "One of the solids that a body was given as.")
      .def_prop_ro(
          "shape", [](const SolidView& s) { return from_shape(s.shape); },
          nb::sig("def shape(self) -> Sphere | Box | Cylinder | Capsule | Torus | Mesh"))
      .def_ro("position", &SolidView::position, "Of the shape's origin, world, m.")
      .def_prop_ro(
          "orientation",
          [](const SolidView& s) {
            return nb::make_tuple(s.orientation.x, s.orientation.y, s.orientation.z, s.orientation.w);
          },
          nb::sig("def orientation(self) -> tuple[float, float, float, float]"),
          "Of the shape's frame: unit quaternion x y z w.");
}

}  // namespace iota::bindings
