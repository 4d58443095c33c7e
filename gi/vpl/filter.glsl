// The geometry-aware filter that joins the panes of interleaved shading (Preiner 2010, section 4.4).
#include "gi/vpl/pixel.glsl"

layout(binding = 8) uniform samplerBuffer diffuse_panes;
layout(binding = 9) uniform samplerBuffer specular_panes;

// Whether two pixels' surfaces are alike: max(0, n.n')^32 exp(-plane distance / (sigma z)) at least 1/e, one standard
// width. sigma z is the extent of an n x n window at the receiver's depth: as far as a plane would rise that is tilted
// by 45 degrees.
bool alike(Receiver receiver, float sigma_z, uvec2 pixel, GBufferTexel texel) {
    vec3 offset = texel_position(camera, pixel, texel) - receiver.position;
    float normals = max(dot(receiver.normal, texel_normal(texel)), 1e-6);
    return texel.depth > 0.0 && 32.0 * log(normals) - abs(dot(receiver.normal, offset)) / sigma_z >= -1.0;
}

// The mean over the panes, so that every VPL counts alike. The n x n window holds one pixel a pane, of which a
// normalised weight is 1 or nothing; where that pixel is of another surface, its neighbours of the same pane n pixels
// away may do. Every pane alone estimates the whole light; a pixel that finds fewer than a quarter of them is shaded
// anew by as many as it lacks.
Gathered filter_panes(uvec2 pixel, Receiver receiver, float depth) {
    int n = int(interleave);
    float sigma_z = float(n) * depth * 2.0 * length(camera.up.xyz) / float(camera.height);
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    uint missing = 0u;  // panes, a bit each: shaded after the loop, where few invocations wait for each other
    for (int i = 0; i < n * n; ++i) {
        ivec2 nearest = ivec2(pixel) + ivec2(i % n, i / n) - (n - 1) / 2;
        ivec2 outward = n * ivec2(nearest.x < int(pixel.x) ? 1 : -1, nearest.y < int(pixel.y) ? 1 : -1);
        bool found = false;
        int j = 0;
        do {
            ivec2 at = nearest + outward * ivec2(j & 1, j >> 1);
            bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(camera.width, camera.height)));
            int index = inside ? at.y * int(camera.width) + at.x : 0;
            found = inside && alike(receiver, sigma_z, uvec2(at), camera_texel(uint(index)));
            if (found) {
                sum.irradiance += texelFetch(diffuse_panes, index).xyz;
#ifdef LUCARNE_GLOSSY
                sum.specular += texelFetch(specular_panes, index).xyz;
#endif
            }
            ++j;
        } while (!found && j < 4);
        ivec2 pane = (nearest + 2 * n) % n;
        if (!found) missing |= 1u << (pane.y * n + pane.x);
    }
    int panes = n * n - bitCount(missing);
    while (4 * panes < n * n) {
        Gathered anew = gather_pane(receiver, uint(findLSB(missing)));
        sum.irradiance += anew.irradiance;
        sum.specular += anew.specular;
        missing &= missing - 1u;
        ++panes;
    }
    return Gathered(sum.irradiance / float(panes), sum.specular / float(panes));
}
