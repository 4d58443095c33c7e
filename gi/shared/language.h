// Makes one text valid C++ and GLSL 4.50: C++ takes the names that GLSL has built in from glm. Shared
// functions are marked LUCARNE_FN and their output parameters LUCARNE_OUT(type). Numbers carry the suffix f,
// which both languages accept.
#ifndef LUCARNE_GI_SHARED_LANGUAGE_H
#define LUCARNE_GI_SHARED_LANGUAGE_H

#ifdef __cplusplus
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/packing.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#define LUCARNE_FN inline
#define LUCARNE_OUT(type) type&

namespace lucarne::gi {
using uint = uint32_t;
using glm::abs, glm::clamp, glm::cross, glm::dot, glm::exp2, glm::inversesqrt, glm::max, glm::min, glm::mix,
    glm::normalize;
using glm::packSnorm2x16, glm::pow, glm::sqrt, glm::unpackSnorm2x16;
using glm::vec2, glm::vec3, glm::vec4, glm::uvec2;
}  // namespace lucarne::gi
#else
#define LUCARNE_FN
#define LUCARNE_OUT(type) out type
#endif

#endif
