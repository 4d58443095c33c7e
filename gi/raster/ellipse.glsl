// Small discs in a picture, to first order about their centres.
#include "gi/raster/disc.glsl"

// A small disc in the picture, to first order about its centre (the error is a share radius/depth of the disc). For
// pixel offsets d from the centre, (distance / radius)^2 is the quadratic form (xx, xy, yy) and the depth has the
// gradient `slope`.
struct Ellipse {
    vec2 centre;  // in pixels, their centres at whole numbers
    float xx, xy, yy;
    vec2 slope;  // m a pixel
    vec2 edge;   // the line at which the disc ends: it covers offsets with dot(edge, d) <= 1
};

Ellipse project(ViewDisc disc) {
    vec2 scale = pixels_per_tangent();
    vec2 place = disc.centre.xy / view_scale(disc.centre.z), tangent = ray_slope(place);
    Ellipse e;
    e.centre = place * scale + view_middle() - 0.5;
    float facing = dot(disc.normal, vec3(tangent, 1.0));
    if (abs(facing) < 1e-4) facing = 1e-4;
    vec2 step = view_scale(disc.centre.z) / scale;  // m a pixel at the centre's depth
    e.slope = -step * disc.normal.xy / facing;
    vec3 along_x = vec3(e.slope.x * tangent + vec2(step.x, 0.0), e.slope.x);
    vec3 along_y = vec3(e.slope.y * tangent + vec2(0.0, step.y), e.slope.y);
    e.edge = vec2(dot(disc.edge, along_x), dot(disc.edge, along_y));
    float inverse = 1.0 / max(disc.radius * disc.radius, 1e-12);
    e.xx = dot(along_x, along_x) * inverse;
    e.xy = 2.0 * dot(along_x, along_y) * inverse;
    e.yy = dot(along_y, along_y) * inverse;
    return e;
}

float ellipse_distance2(Ellipse e, vec2 d) { return d.x * (e.xx * d.x + e.xy * d.y) + e.yy * d.y * d.y; }
