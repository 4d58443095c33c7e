// Surfels as opaque discs, for C++, GLSL and OpenCL C: where a ray meets a disc, the order of discs along a
// ray, and the box of a disc in a picture. Native passes have ray and order for vectors
// (gi/raster/native/disc-inl.h), which a test compares with this text; Embree has discs of its own
// (gi/tracing).
#ifndef LUCARNE_GI_SHARED_DISC_H
#define LUCARNE_GI_SHARED_DISC_H

#include "gi/shared/edge.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Up to this radius, in pixels, discs are drawn to first order about their centres, pixel by pixel; larger
// ones exactly.
LUCARNE_CONST float kSmallRadius = 8.0f;
// The order of a disc along a ray that misses it.
LUCARNE_CONST uint kNoKey = 0xffffffffu;

// A disc in the space of a view: x right, y down, z along the forward axis (the depth), metres. In
// perspective the ray through a pixel starts at the eye and has the direction (x, y, 1); in an orthographic
// view it starts at (x, y, 0) and has the direction (0, 0, 1). A ray's parameter is then its depth.
LUCARNE_STRUCT(ViewDisc) {
    vec3 centre;
    vec3 normal;
    float radius;
    float extent;  // half the range of depths that it spans, m
    float push;    // by which its rim is pushed back, m of depth (kRimPush)
    vec3 edge;     // the line at which it ends, 1/m (edge.h); zero: none
};

// Where a ray meets the plane of a disc.
LUCARNE_STRUCT(DiscHit) {
    float t;          // parameter of the ray
    float distance2;  // squared distance from the centre, m^2
    vec3 offset;      // from the centre, m
};

// Intersects a ray with the plane of a disc whose centre is given relative to the start of the ray. Every
// pass must compute the same bits.
LUCARNE_FN DiscHit meet_disc(vec3 centre, vec3 normal, vec3 ray) {
    LUCARNE_PRECISE float slope = dot(normal, ray);
    LUCARNE_PRECISE float t = dot(normal, centre) / (abs(slope) < 1e-12f ? 1e-12f : slope);
    LUCARNE_PRECISE vec3 offset = ray * t - centre;
    LUCARNE_PRECISE float distance2 = dot(offset, offset);
    DiscHit hit;
    hit.t = t;
    hit.distance2 = distance2;
    hit.offset = offset;
    return hit;
}
// Returns whether a hit lies on a disc without a line (within_edge).
LUCARNE_FN bool on_disc(DiscHit hit, float radius) {
    return hit.distance2 <= radius * radius;
}

// Returns how far a disc reaches from its centre along an axis, m; `cosine` is that between axis and normal.
LUCARNE_FN float disc_reach(float radius, float cosine) {
    return radius * sqrt(max(1.0f - cosine * cosine, 0.0f));
}

// Limits a depth to those that the disc spans.
LUCARNE_FN float disc_depth_within(ViewDisc disc, float z) {
    return clamp(z, disc.centre.z - disc.extent, disc.centre.z + disc.extent);
}
// Returns the depth where a ray of the view meets the plane of the disc, limited to the depths that the disc
// spans (a plane seen edge-on would put its pixel anywhere).
LUCARNE_FN float disc_depth(ViewDisc disc, vec3 start, vec3 ray) {
    float slope = dot(disc.normal, ray);
    if (abs(slope) < 1e-12f) return disc.centre.z;
    return disc_depth_within(disc, dot(disc.normal, disc.centre - start) / slope);
}

// Returns the order of the disc along a ray of the view, or kNoKey if the ray misses it. The order is the
// bits of a positive float, so that integers compare like depths. `near`: the near plane, m. A disc always
// competes for the pixel of its centre (`at_home`).
LUCARNE_FN uint disc_key(ViewDisc disc, vec3 start, vec3 ray, float near, bool at_home) {
    LUCARNE_PRECISE vec3 centre = disc.centre - start;
    DiscHit hit = meet_disc(centre, disc.normal, ray);
    float r2 = disc.radius * disc.radius;
    bool inside = on_disc(hit, disc.radius) && within_edge(disc.edge, hit.offset);
    if (!inside && !at_home) return kNoKey;
    float z = disc_depth_within(disc, hit.t);
    if (!(z > near)) return kNoKey;
    LUCARNE_PRECISE float key = z + disc.push * (inside && r2 > 0.0f ? hit.distance2 / r2 : 1.0f);
    return floatBitsToUint(key);
}

// Returns the range of x/z, or of y/z, of a disc in front of the eye: the tangents of the two planes through
// the eye that touch it. `along` and `normal` are the components of its centre and its normal on that axis.
// With a = (1, 0, -u): (a.c)^2 = r^2 (|a|^2 - (a.n)^2), a quadratic in u. In an orthographic view it is the
// range of x or y.
LUCARNE_FN vec2 disc_range(ViewDisc disc, float along, float normal, bool parallel) {
    if (parallel) return along + disc_reach(disc.radius, normal) * vec2(-1.0f, 1.0f);
    float r2 = disc.radius * disc.radius;
    float a = disc.centre.z * disc.centre.z - disc.extent * disc.extent;
    float b = along * disc.centre.z + r2 * normal * disc.normal.z;
    float c = along * along - r2 * (1.0f - normal * normal);
    float root = sqrt(max(b * b - a * c, 0.0f));
    return vec2(b - root, b + root) / a;
}

// The picture that a box lies in.
LUCARNE_STRUCT(DiscPicture) {
    vec2 size;    // pixels
    vec2 scale;   // pixels per unit of x/z, or per metre in an orthographic view
    vec2 middle;  // place of the forward axis, pixels
    float near;   // the near plane, m
    bool parallel;
};

// Pixels first to last whose middles the disc may cover, within the picture: whole numbers. There are none if
// first exceeds last.
LUCARNE_STRUCT(DiscBox) {
    vec2 first, last;
    vec2 home;  // the pixel of its centre, for which it always competes; outside the picture if it has none
};

// Moves a place before or behind a picture to its border or a pixel outside it. NaN becomes -1.
LUCARNE_FN float place_within(float at, float size) {
    return at > -1.0f ? min(at, size) : -1.0f;
}

LUCARNE_FN DiscBox disc_box(ViewDisc disc, DiscPicture picture) {
    DiscBox box;
    box.first = vec2(0.0f);
    box.last = picture.size - 1.0f;
    box.home = vec2(-1.0f);
    if (disc.centre.z > picture.near) {
        vec2 place =
            vec2(disc.centre.x, disc.centre.y) / (picture.parallel ? 1.0f : disc.centre.z) * picture.scale +
            picture.middle;
        box.home = floor(vec2(place_within(place.x, picture.size.x), place_within(place.y, picture.size.y)));
    }
    if (!picture.parallel && !(disc.centre.z > 1.001f * disc.extent))
        return box;  // it reaches behind the eye
    vec2 x = disc_range(disc, disc.centre.x, disc.normal.x, picture.parallel);
    vec2 y = disc_range(disc, disc.centre.y, disc.normal.y, picture.parallel);
    vec2 low = vec2(x.x, y.x) * picture.scale + picture.middle - 0.5f;
    vec2 high = vec2(x.y, y.y) * picture.scale + picture.middle - 0.5f;
    low = ceil(vec2(place_within(low.x, picture.size.x), place_within(low.y, picture.size.y)));
    high = floor(vec2(place_within(high.x, picture.size.x), place_within(high.y, picture.size.y)));
    box.first = max(min(low, box.home), vec2(0.0f));
    box.last = min(max(high, box.home), box.last);
    return box;
}
LUCARNE_FN bool is_empty(DiscBox box) {
    return box.first.x > box.last.x || box.first.y > box.last.y;
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
