// SPDX-License-Identifier: Apache-2.0
// Shapes: one class each, made from the list (src/shape/shape_list.h). Only a mesh, which has tables instead of sizes, is
// bound by hand.
#include "binders.h"
#include "shape/mesh.h"
#include "shape/shape.h"
#include "shape/shape_list.h"
#include "shape_argument.h"

namespace iota::bindings {

namespace {

constexpr const char* mesh_doc =
    "The volume within a closed surface of triangles. vertices: (n, 3), m. triangles: (k, 3) indices, from outside\n"
    "counter-clockwise. Raises ValueError if the surface is open, inside out, flat, inconsistently wound or has\n"
    "invalid indices; the text names the triangle or edge. closed=False takes any triangles, for obstacles.\n\n"
    "    iota.Mesh.load('part.stl')         # any format that trimesh reads, if it is installed\n"
    "    iota.Mesh.convex_hull(points) # the convex hull\n"
    "    iota.Mesh.height_field(heights, (20, 20)) # land of 20 m by 20 m";

nb::object numbers_of(nb::handle values, const char* dtype, const char* name) {
  try {
    return nb::module_::import_("numpy").attr("ascontiguousarray")(values, dtype);
  } catch (const nb::python_error&) {
    throw nb::value_error((std::string(name) + " must be an array of numbers, not " + describe(values)).c_str());
  }
}

nb::object array_of(nb::handle values, const char* dtype, const char* name) {
  nb::object array = numbers_of(values, dtype, name);
  if (nb::cast<int>(array.attr("ndim")) != 2 || nb::cast<int>(array.attr("shape")[nb::int_(1)]) != 3) {
    const std::string text =
        std::string(name) + " must have the shape (n, 3), not " + nb::repr(array.attr("shape")).c_str();
    throw nb::value_error(text.c_str());
  }
  return array;
}

}  // namespace

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
      // A value out of range becomes a number that the engine refuses by name.
      triangle[k] = vertex < 0 || vertex > 0xffffffff ? 0xffffffffu : static_cast<std::uint32_t>(vertex);
    }
  }
  return mesh;
}

namespace {

nb::object matrix(const Matrix3& rows) {
  std::vector<double> numbers;
  for (const Vec3& row : rows) numbers.insert(numbers.end(), {row.x, row.y, row.z});
  return nb::cast(make_vector3_array(std::move(numbers)));
}

// --- from the list ----------------------------------------------------------------------------------------------------

/// "half_space" -> "HalfSpace".
std::string class_name(std::string_view name) {
  std::string out;
  bool begins = true;
  for (const char c : name) {
    if (c != '_') out += begins ? static_cast<char>(std::toupper(c)) : c;
    begins = c == '_';
  }
  return out;
}

/// The docstring of the class: the shape, and its sizes.
template <class S>
std::string doc_of() {
  std::string text(shape::Traits<S>::doc);
  std::apply(
      [&](const auto&... size) { ((text += "\n" + std::string(size.name) + ": " + std::string(size.doc) + "."), ...); },
      shape::Traits<S>::sizes);
  return text;
}

double from_argument(double value, const char*) { return value; }
Vec3 from_argument(VectorArgument value, const char* name) { return to_vec3(value, name); }
nb::object to_argument(double value) { return nb::float_(value); }
nb::object to_argument(const Vec3& v) { return nb::make_tuple(v.x, v.y, v.z); }

/// The constructor, with checks, and one property for each size.
template <class S, class... T, std::size_t... I>
void def_sizes(nb::class_<S>& type, const std::tuple<shape::Size<S, T>...>& sizes, std::index_sequence<I...>) {
  const auto argument = [&]<std::size_t Index>(std::integral_constant<std::size_t, Index>) {
    constexpr auto size = std::get<Index>(shape::Traits<S>::sizes);
    if constexpr (size.range == shape::Range::length)
      return nb::arg(size.name.data());
    else
      return nb::arg(size.name.data()) = to_argument(S{}.*size.member);
  };
  type.def(
      "__init__",
      [](S* self, std::conditional_t<std::is_same_v<T, Vec3>, VectorArgument, double>... values) {
        S made;
        ((made.*std::get<I>(shape::Traits<S>::sizes).member =
              from_argument(values, std::get<I>(shape::Traits<S>::sizes).name.data())),
         ...);
        shape::check(made);
        new (self) S(made);
      },
      argument(std::integral_constant<std::size_t, I>{})...);
  (type.def_ro(std::get<I>(sizes).name.data(), std::get<I>(sizes).member, std::get<I>(sizes).doc.data()), ...);
  type.def("__repr__", [](nb::handle self) {
    std::string text = class_name(shape::Traits<S>::name) + "(";
    const S& s = *nb::inst_ptr<S>(self);
    const char* between = "";
    const auto add = [&](const auto& size) {
      text += between + std::string(size.name) + "=" + nb::repr(to_argument(s.*size.member)).c_str();
      between = ", ";
    };
    std::apply([&](const auto&... size) { (add(size), ...); }, shape::Traits<S>::sizes);
    return text + ")";
  });
  type.def("__hash__", [](const S& s) {
    nb::list numbers;
    for (const double v : shape::to_data(s).sizes) numbers.append(v);
    return nb::hash(nb::tuple(numbers));
  });
}

/// The properties and functions of every shape.
template <class S>
void def_common(nb::class_<S>& type) {
  type.attr("kind") = shape::Traits<S>::name;
  type.def_prop_ro_static(
          "sizes",
          [](nb::handle) {
            nb::list names;
            std::apply([&](const auto&... size) { (names.append(size.name), ...); }, shape::Traits<S>::sizes);
            return nb::tuple(names);
          },
          nb::sig("def sizes(cls, /) -> tuple[str, ...]"), "The names of its sizes, as its constructor takes them.")
      .def_prop_ro(
          "numbers",
          [](const S& s) {
            nb::list numbers;
            const shape::Data data = shape::to_data(s);
            for (std::size_t i = 0; i < shape::size_names(s).size(); ++i) numbers.append(data.sizes[i]);
            return nb::tuple(numbers);
          },
          nb::sig("def numbers(self) -> tuple[float, ...]"), "All sizes in one list, as sent to pages.")
      .def_prop_ro(
          "bounds",
          [](const S& s) {
            const shape::Bounds b = shape::bounds(s);
            return nb::make_tuple(b.low, b.high);
          },
          nb::sig("def bounds(self) -> tuple[Vec3, Vec3]"),
          "Lowest and highest corner of the least box along the axes, m; those of a half-space are infinite.")
      .def_prop_ro(
          "mass_properties", [](const S& s) { return mass_properties(s); },
          "Volume, center and second moments. Raises ValueError for a shape without a volume.")
      .def(
          "distance", [](const S& s, VectorArgument p) { return shape::distance(s, to_vec3(p, "point")); }, "point"_a,
          "From a point to the surface, negative inside, m. The point is in the shape's frame.")
      .def(
          "closest", [](const S& s, VectorArgument p) { return shape::closest(s, to_vec3(p, "point")); }, "point"_a,
          "The point of the surface that is nearest to a point, both in the shape's frame, m.")
      .def(
          "__eq__",
          [](const S& s, nb::handle other) { return nb::isinstance<S>(other) && s == *nb::inst_ptr<S>(other); },
          nb::sig("def __eq__(self, other: object, /) -> bool"), nb::is_operator());
}

void def_mesh(nb::class_<Mesh>& type) {
  type.def(
          "__init__",
          [](Mesh* self, nb::object vertices, nb::object triangles, bool closed) {
            Mesh made = make_mesh(vertices, triangles);
            if (closed)
              (void)mass_properties(made);  // throws unless it is
            else
              shape::Traits<Mesh>::check_triangles(made);
            new (self) Mesh(std::move(made));
          },
          "vertices"_a, "triangles"_a, nb::kw_only(), "closed"_a = true,
          nb::sig(
              "def __init__(self, vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, *, closed: bool = "
              "True) -> None"))
      .def_prop_ro(
          "closed", [](const Mesh& mesh) { return shape::Traits<Mesh>::has_volume(mesh); },
          "Whether it encloses a volume. If not, only static bodies can have it, see `System.obstacle`.")
      .def_static(
          "load",
          [](nb::object path) {
            const nb::object read = nb::module_::import_("iota.shapelib.surface_files").attr("read_any")(path);
            Mesh made = make_mesh(read[0], read[1]);
            (void)mass_properties(made);
            return made;
          },
          "path"_a, nb::sig("def load(path: str | os.PathLike[str]) -> Mesh"),
          "Reads a file of any format that trimesh knows, in a process of its own. Raises ValueError that names the file, and\n"
          "ImportError without trimesh.")
      .def_static(
          "convex_hull",
          [](nb::handle points) {
            const nb::object places = array_of(points, "float64", "points");
            const auto x = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(places);
            static_assert(sizeof(Vec3) == 3 * sizeof(double));
            return convex_hull({reinterpret_cast<const Vec3*>(x.data()), x.shape(0)});
          },
          "points"_a, nb::sig("def convex_hull(points: numpy.typing.ArrayLike) -> Mesh"),
          "The convex hull of points, (n, 3), m; inner, coplanar and duplicate points are allowed. Raises\n"
          "ValueError for fewer than four, for non-finite ones, and if all are in one plane or on one line.")
      .def_static(
          "height_field",
          [](nb::handle heights, std::pair<double, double> size) {
            const nb::object rows = numbers_of(heights, "float64", "heights");
            const auto x = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(rows);
            if (x.ndim() != 2)
              throw nb::value_error((std::string("heights must be rows along x of columns along z, (n, m), not ") +
                                     nb::repr(rows.attr("shape")).c_str())
                                        .c_str());
            return height_field({x.data(), x.size()}, x.shape(0), x.shape(1), size.first, size.second);
          },
          "heights"_a, "size"_a,
          nb::sig("def height_field(heights: numpy.typing.ArrayLike, size: tuple[float, float]) -> Mesh"),
          "Land, an open mesh for obstacles. heights: (n, m), m, above y = 0, at the corners of a grid whose rows go along x and\n"
          "whose columns go along z. size: of all of it in x and z, m; its middle is the origin. Raises ValueError for fewer than two rows\n"
          "or columns, heights that are not finite and sizes that are not positive.\n\n"
          "    x = numpy.linspace(-10, 10, 80)\n"
          "    hills = iota.Mesh.height_field(numpy.sin(x)[:, None] * numpy.cos(x), (20, 20))\n"
          "    system.obstacle(hills)")
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
        return "<Mesh: " + std::to_string(m.vertices.size()) + " vertices, " + std::to_string(m.triangles.size()) +
               " triangles>";
      });
}

void bind_solid(nb::module_& module) {
  nb::class_<SolidView>(module, "Solid", "A solid of a body.")
      .def_prop_ro(
          "shape", [](const SolidView& s) { return from_shape(s.shape); }, nb::sig("def shape(self) -> Shape"))
      .def_ro("position", &SolidView::position, "Of the shape's origin, world, m.")
      .def_prop_ro(
          "orientation",
          [](const SolidView& s) {
            return nb::make_tuple(s.orientation.x, s.orientation.y, s.orientation.z, s.orientation.w);
          },
          nb::sig("def orientation(self) -> tuple[float, float, float, float]"),
          "Of the shape's frame: unit quaternion x y z w.");
}

}  // namespace

Shape to_shape(nb::handle value) {
  std::optional<Shape> shape;
  std::string names;
  shape::for_each_shape([&]<class S>(const S&) {
    if (nb::isinstance<S>(value)) shape = nb::cast<S>(value);
    names += (names.empty() ? "" : ", ") + class_name(shape::Traits<S>::name);
  });
  if (!shape) throw nb::type_error(("a shape must be one of " + names + ", not " + describe(value)).c_str());
  return *shape;
}

bool is_shape(nb::handle value) {
  bool found = false;
  shape::for_each_shape([&]<class S>(const S&) { found = found || nb::isinstance<S>(value); });
  return found;
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

  nb::list types;
  shape::for_each_shape([&]<class S>(const S&) {
    if constexpr (std::is_same_v<S, Mesh>) {
      nb::class_<Mesh> type(module, "Mesh", mesh_doc);
      def_mesh(type), def_common(type);
      types.append(type);
    } else {
      constexpr auto& sizes = shape::Traits<S>::sizes;
      static const std::string name = class_name(shape::Traits<S>::name), doc = doc_of<S>();
      nb::class_<S> type(module, name.c_str(), doc.c_str());
      def_sizes(type, sizes, std::make_index_sequence<std::tuple_size_v<std::remove_cvref_t<decltype(sizes)>>>{});
      def_common(type);
      types.append(type);
    }
  });
  module.attr("Shape") = nb::module_::import_("typing").attr("Union")[nb::tuple(types)];
  bind_solid(module);
}

}  // namespace iota::bindings
