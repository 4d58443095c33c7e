// Makes one text valid C++, GLSL 4.50 and OpenCL C 1.2. The text is written with GLSL's names: C++ takes them
// from glm, and OpenCL C gets them as macros. Besides, the text uses
//   LUCARNE_FN           before a function,
//   LUCARNE_CONST        before a constant at file scope,
//   LUCARNE_STRUCT(T)    in place of `struct T` where T is defined,
//   LUCARNE_VEC3         for a vec3 in a struct that buffers hold: always 12 bytes (OpenCL's vec3 takes 16),
//   LUCARNE_PRECISE      before a local variable that all programs have to compute to the same bits,
//   LUCARNE_OUT(type)    as the type of an output parameter, a pointer in OpenCL C: the function uses it as
//                        LUCARNE_VALUE(name), and a caller in a shared text passes LUCARNE_REF(name).
// It has no v[i] for vectors, which OpenCL C lacks. Numbers carry the suffix f, which all languages accept.
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
#define LUCARNE_CONST constexpr
#define LUCARNE_STRUCT(name) struct name
#define LUCARNE_VEC3 vec3
#define LUCARNE_PRECISE
#define LUCARNE_OUT(type) type&
#define LUCARNE_VALUE(name) name
#define LUCARNE_REF(name) name

namespace lucarne::gi {
using uint = uint32_t;
using glm::abs, glm::ceil, glm::clamp, glm::cross, glm::dot, glm::exp2, glm::floor, glm::inversesqrt,
    glm::length, glm::log, glm::log2, glm::max, glm::min, glm::mix, glm::normalize, glm::pow, glm::sqrt;
using glm::floatBitsToUint, glm::packSnorm2x16, glm::uintBitsToFloat, glm::unpackHalf2x16,
    glm::unpackSnorm2x16;
using glm::ivec2, glm::uvec2, glm::vec2, glm::vec3, glm::vec4;
}  // namespace lucarne::gi
#elif defined(__OPENCL_C_VERSION__)
#define LUCARNE_FN static inline
#define LUCARNE_CONST __constant
#define LUCARNE_STRUCT(name)  \
    typedef struct name name; \
    struct name
#define LUCARNE_VEC3 PlainVec3
#define LUCARNE_PRECISE
#define LUCARNE_OUT(type) type*
#define LUCARNE_VALUE(name) (*(name))
#define LUCARNE_REF(name) (&(name))

typedef int2 ivec2;
typedef float2 vec2;
typedef float3 vec3;
typedef float4 vec4;
typedef struct {
    float x, y, z;
} PlainVec3;
// Before parentheses these names are constructors; elsewhere they remain types.
#define int(value) ((int)(value))
#define uint(value) ((uint)(value))
#define float(value) ((float)(value))
#define ivec2(...) ((int2)(__VA_ARGS__))
#define vec2(...) ((float2)(__VA_ARGS__))
#define vec3(...) ((float3)(__VA_ARGS__))
#define vec4(...) ((float4)(__VA_ARGS__))
// OpenCL's own abs is for integers; kernels that include this file have only GLSL's, for floats.
#undef abs
#define abs fabs
#define inversesqrt rsqrt
#define floatBitsToUint(value) as_uint((float)(value))
#define uintBitsToFloat(value) as_float((uint)(value))

// Convert two numbers in [-1, 1] to 16-bit fractions and back, as in GLSL.
LUCARNE_FN uint packSnorm2x16(vec2 v) {
    return as_uint(convert_short2(round(clamp(v, -1.0f, 1.0f) * 32767.0f)));
}
LUCARNE_FN vec2 unpackSnorm2x16(uint code) {
    return clamp(convert_float2(as_short2(code)) / 32767.0f, -1.0f, 1.0f);
}
// Converts two half floats, as in GLSL.
LUCARNE_FN vec2 unpackHalf2x16(uint code) {
    ushort2 halves = as_ushort2(code);
    return vload_half2(0, (const half*)&halves);
}
#else
#define LUCARNE_FN
#define LUCARNE_CONST const
#define LUCARNE_STRUCT(name) struct name
#define LUCARNE_VEC3 vec3
#define LUCARNE_PRECISE precise
#define LUCARNE_OUT(type) out type
#define LUCARNE_VALUE(name) name
#define LUCARNE_REF(name) name
#endif

#ifdef __cplusplus
namespace lucarne::gi {
#endif
LUCARNE_FN vec3 xyz_of(vec4 v) {
    return vec3(v.x, v.y, v.z);
}
#ifdef __cplusplus
}  // namespace lucarne::gi
#endif

#endif
