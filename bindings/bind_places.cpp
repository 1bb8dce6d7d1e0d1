// SPDX-License-Identifier: Apache-2.0
#include "places_object.h"

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
          "The bodies that a convex shape at a place would overlap.");
}

}  // namespace iota::bindings
