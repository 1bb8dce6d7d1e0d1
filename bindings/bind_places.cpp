// SPDX-License-Identifier: Apache-2.0
#include "places_object.h"

#include "array_argument.h"
#include "binders.h"
#include "shape_argument.h"
#include "typed_argument.h"

namespace iota::bindings {

namespace {

using Only = std::optional<std::vector<BodyHandle>>;

/// The ids of bodies, which must not be gone.
class Ids {
 public:
  explicit Ids(const Only& only) : is_all_(!only) {
    if (!only) return;
    for (const BodyHandle& body : *only) body.use(), ids_.push_back(body.id);
  }
  std::optional<std::span<const BodyId>> get() const {
    if (is_all_) return std::nullopt;
    return ids_;
  }

 private:
  bool is_all_;
  std::vector<BodyId> ids_;
};

nb::object to_tuple(PlacesObject& self, const std::optional<Hit>& hit) {
  if (!hit) return nb::none();
  return nb::make_tuple(BodyHandle{self.system_object, self.system, hit->body}, hit->point, hit->distance);
}

/// The answers to many questions: slots of bodies or -1, places, distances; infinite without an answer.
template <class Ask>
nb::object to_arrays(std::size_t count, Ask ask) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto owned = [](auto* numbers) {
    return nb::capsule(numbers, [](void* p) noexcept { delete[] static_cast<decltype(numbers)>(p); });
  };
  auto* const slots = new std::int64_t[count + 1];
  const nb::capsule of_slots = owned(slots);
  auto* const points = new double[3 * count + 1];
  const nb::capsule of_points = owned(points);
  auto* const distances = new double[count + 1];
  const nb::capsule of_distances = owned(distances);
  for (std::size_t k = 0; k < count; ++k) {
    const std::optional<Hit> hit = ask(k);
    const Vec3 point = hit ? hit->point : Vec3{infinity, infinity, infinity};
    slots[k] = hit ? static_cast<std::int64_t>(hit->body.slot) : -1;
    points[3 * k] = point.x, points[3 * k + 1] = point.y, points[3 * k + 2] = point.z;
    distances[k] = hit ? hit->distance : infinity;
  }
  return nb::make_tuple(nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>(slots, {count}, of_slots),
                        nb::ndarray<nb::numpy, double, nb::ndim<2>>(points, {count, 3}, of_points),
                        nb::ndarray<nb::numpy, double, nb::ndim<1>>(distances, {count}, of_distances));
}

Vec3 row(std::span<const double> rows, std::size_t k) { return {rows[3 * k], rows[3 * k + 1], rows[3 * k + 2]}; }

constexpr const char* arrays_type =
    "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]";
constexpr const char* hit_type = "tuple[Body, Vec3, float] | None";

}  // namespace

void bind_places(nb::module_& module) {
  nb::class_<PlacesObject>(module, "Places", "Questions about the places of bodies; a World asks them.",
                           nb::type_slots(handle_slots<PlacesObject>))
      .def(
          "__init__", [](PlacesObject* self, nb::object system) { new (self) PlacesObject(std::move(system)); },
          "system"_a)
      .def(
          "ray",
          [](PlacesObject& self, VectorArgument from, VectorArgument direction, double farthest, const Only& only) {
            const Ids ids(only);
            return to_tuple(
                self, self.use().ray(to_vec3(from, "origin"), to_vec3(direction, "direction"), farthest, ids.get()));
          },
          "origin"_a, "direction"_a, "farthest"_a, "bodies"_a.none(),
          nb::sig((std::string("def ray(self, origin: Vec3, direction: Vec3, farthest: float, bodies: list[Body] | "
                               "None) -> ") +
                   hit_type)
                      .c_str()),
          "The first thing that a ray meets, the place and its distance.")
      .def(
          "nearest",
          [](PlacesObject& self, VectorArgument place, const Only& only) {
            const Ids ids(only);
            return to_tuple(self, self.use().nearest(to_vec3(place, "place"), ids.get()));
          },
          "place"_a, "bodies"_a.none(),
          nb::sig((std::string("def nearest(self, place: Vec3, bodies: list[Body] | None) -> ") + hit_type).c_str()),
          "The thing whose surface is nearest, the place on it and its distance.")
      .def(
          "within",
          [](PlacesObject& self, VectorArgument place, double radius, const Only& only) {
            const Ids ids(only);
            const auto found = self.use().within(to_vec3(place, "place"), radius, ids.get());
            return wrap_all<BodyHandle>(self.system_object, self.system, found);
          },
          "place"_a, "radius"_a, "bodies"_a.none(), "The bodies that a ball overlaps.")
      .def(
          "overlap",
          [](PlacesObject& self, nb::handle shape, VectorArgument position, QuaternionArgument rotation,
             const Only& only) {
            const Ids ids(only);
            const auto found = self.use().overlap(to_shape(shape), to_vec3(position, "position"),
                                                  to_quaternion(rotation, "rotation"), ids.get());
            return wrap_all<BodyHandle>(self.system_object, self.system, found);
          },
          "shape"_a, "position"_a, "rotation"_a, "bodies"_a.none(),
          nb::sig("def overlap(self, shape: Shape, position: Vec3, rotation: collections.abc.Sequence[float], bodies: "
                  "list[Body] | None) -> list[Body]"),
          "The bodies that a convex shape at a place would overlap.")
      .def(
          "cast",
          [](PlacesObject& self, nb::handle shape, VectorArgument position, VectorArgument direction, double farthest,
             QuaternionArgument rotation, const Only& only) {
            const Ids ids(only);
            return to_tuple(self, self.use().cast(to_shape(shape), to_vec3(position, "position"),
                                                  to_quaternion(rotation, "rotation"), to_vec3(direction, "direction"),
                                                  farthest, ids.get()));
          },
          "shape"_a, "position"_a, "direction"_a, "farthest"_a, "rotation"_a, "bodies"_a.none(),
          nb::sig(
              (std::string("def cast(self, shape: Shape, position: Vec3, direction: Vec3, farthest: float, rotation: "
                           "collections.abc.Sequence[float], bodies: list[Body] | None) -> ") +
               hit_type)
                  .c_str()),
          "The first thing that a convex shape meets on a straight way, the place and how far it goes.")
      .def(
          "gap",
          [](PlacesObject& self, const BodyHandle& body, const BodyHandle& other) {
            body.use(), other.use();
            const Gap found = self.use().gap(body.id, other.id);
            return nb::make_tuple(found.distance, found.point, found.other_point);
          },
          "body"_a, "other"_a, nb::sig("def gap(self, body: Body, other: Body) -> tuple[float, Vec3, Vec3]"),
          "The distance of two bodies, and the nearest place of each.")
      .def(
          "rays",
          [](PlacesObject& self, nb::handle origins, nb::handle directions, std::size_t count, double farthest,
             const Only& only) {
            const Ids ids(only);
            nb::object kept[2];
            const auto from = view_rows(origins, count, "origins", "place", kept[0]),
                       along = view_rows(directions, count, "directions", "direction", kept[1]);
            return to_arrays(
                count, [&](std::size_t k) { return self.use().ray(row(from, k), row(along, k), farthest, ids.get()); });
          },
          "origins"_a, "directions"_a, "count"_a, "farthest"_a, "bodies"_a.none(),
          nb::sig((std::string("def rays(self, origins: numpy.typing.ArrayLike, directions: numpy.typing.ArrayLike, "
                               "count: int, farthest: float, bodies: list[Body] | None) -> ") +
                   arrays_type)
                      .c_str()),
          "As `ray`, of many: slots, places and distances.")
      .def(
          "nearest_each",
          [](PlacesObject& self, nb::handle places, std::size_t count, const Only& only) {
            const Ids ids(only);
            nb::object kept;
            const auto at = view_rows(places, count, "places", "place", kept);
            return to_arrays(count, [&](std::size_t k) { return self.use().nearest(row(at, k), ids.get()); });
          },
          "places"_a, "count"_a, "bodies"_a.none(),
          nb::sig(
              (std::string("def nearest_each(self, places: numpy.typing.ArrayLike, count: int, bodies: list[Body] | "
                           "None) -> ") +
               arrays_type)
                  .c_str()),
          "As `nearest`, of many: slots, places and distances.");
}

}  // namespace iota::bindings
