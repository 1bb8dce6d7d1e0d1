// SPDX-License-Identifier: Apache-2.0
#include "read/attributes.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::read {
namespace {

/// One particle of an emitter whose curve has keys at 0.25, 0.5 and 0.75 of a life of 4 s.
struct Spark {
  model::SmallModel small;
  std::uint32_t particle = small.particle(small.body({{}}), 0);
  std::uint32_t slot = 0;

  Spark() {
    ingredient::Emitter emitter;
    emitter.key_count = 3;
    emitter.keys[0] = {0.25, 1, {0, 0, 0, 1}};
    emitter.keys[1] = {0.5, 3, {1, 0, 0, 1}};
    emitter.keys[2] = {0.75, 2, {1, 1, 0, 0}};
    model::Attributes attributes;
    attributes.particle = particle, attributes.lifetime = 4, attributes.radius = 9;
    attributes.emitter = small.model.emitters.create(emitter).slot;
    slot = small.model.particles[particle].attributes = small.model.attributes.create(attributes).slot;
  }
  ParticleAttributes at(double age) {
    small.model.attributes[slot].age = age;
    return attributes(small.model, small.model.attributes[slot]);
  }
};

TEST(Attributes, of_an_emitters_particle_are_linear_between_the_keys_of_its_curve_and_constant_beyond) {
  Spark spark;
  EXPECT_EQ(spark.at(0).radius, 1);
  EXPECT_EQ(spark.at(1).radius, 1);
  EXPECT_DOUBLE_EQ(spark.at(1.5).radius, 2);
  EXPECT_FLOAT_EQ(spark.at(1.5).color[0], 0.5f);
  EXPECT_EQ(spark.at(2).radius, 3);
  EXPECT_DOUBLE_EQ(spark.at(2.25).radius, 2.75);
  EXPECT_FLOAT_EQ(spark.at(2.25).color[1], 0.25f);
  EXPECT_FLOAT_EQ(spark.at(2.25).color[3], 0.75f);
  EXPECT_EQ(spark.at(3).radius, 2);
  EXPECT_EQ(spark.at(100).radius, 2);
}

TEST(Attributes, of_a_curve_of_one_key_or_none_are_constant) {
  Spark spark;
  spark.small.model.emitters[0].key_count = 1;
  for (const double age : {0.0, 1.0, 4.0}) EXPECT_EQ(spark.at(age).radius, 1);
  spark.small.model.emitters[0].key_count = 0;
  for (const double age : {0.0, 1.0, 4.0}) EXPECT_EQ(spark.at(age).radius, 9);
}

TEST(Attributes, are_found_only_where_a_particle_has_them_and_is_oriented) {
  Spark spark;
  const std::uint32_t plain = spark.small.particle(spark.small.body({{1, 0, 0}}), 0);
  EXPECT_EQ(find_attributes(spark.small.model, plain), nullptr);
  EXPECT_EQ(find_attributes(spark.small.model, spark.particle), &spark.small.model.attributes[spark.slot]);
  EXPECT_THROW((void)oriented_attributes(spark.small.model, plain), std::invalid_argument);
  EXPECT_THROW((void)oriented_attributes(spark.small.model, spark.particle), std::invalid_argument);
  spark.small.model.attributes[spark.slot].oriented = 1;
  EXPECT_EQ(&oriented_attributes(spark.small.model, spark.particle), &spark.small.model.attributes[spark.slot]);
}

}  // namespace
}  // namespace iota::read
