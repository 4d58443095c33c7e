// The geometry-aware filter that joins the panes of interleaved shading (Preiner 2010, section 4.4).
#include "gi/vpl/pixel.glsl"

// How alike two pixels' surfaces are, in [0, 1]: max(0, n.n')^32 exp(-plane distance / (sigma z)). sigma z is the
// extent of an n x n window at the receiver's depth: as far as a plane would rise that is tilted by 45 degrees.
float alike(Receiver receiver, float sigma_z, uvec2 pixel, GBufferTexel texel) {
    vec3 offset = texel_position(camera, pixel, texel) - receiver.position;
    float normals = max(dot(receiver.normal, texel_normal(texel)), 0.0);
    return pow(normals, 32.0) * exp(-abs(dot(receiver.normal, offset)) / sigma_z);
}

// Less than one standard width of the weight above: another surface.
const float kLeastWeight = 0.3679;

// The mean over the panes, so that every VPL counts alike. The n x n window holds one pixel a pane, of which a
// normalised weight is 1 or nothing; where that pixel is of another surface, its neighbours of the same pane n pixels
// away may do, and where none does this pixel is shaded anew by that pane's VPLs.
Gathered filter_panes(uvec2 pixel, Receiver receiver, float depth) {
    int n = int(interleave);
    float sigma_z = float(n) * depth * 2.0 * length(camera.up.xyz) / float(camera.height);
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    uint missing = 0u;  // panes, a bit each: shaded after the loop, where few invocations wait for each other
    for (int i = 0; i < n * n; ++i) {
        ivec2 nearest = ivec2(pixel) + ivec2(i % n, i / n) - (n - 1) / 2;
        ivec2 outward = n * ivec2(nearest.x < int(pixel.x) ? 1 : -1, nearest.y < int(pixel.y) ? 1 : -1);
        bool found = false;
        for (int j = 0; j < 4 && !found; ++j) {
            ivec2 at = nearest + outward * ivec2(j & 1, j >> 1);
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(camera.width, camera.height)))) continue;
            uint index = uint(at.y) * camera.width + uint(at.x);
            GBufferTexel texel = texels[index];
            found = texel.depth > 0.0 && alike(receiver, sigma_z, uvec2(at), texel) >= kLeastWeight;
            if (!found) continue;
            sum.irradiance += diffuse_light[index].xyz;
#ifdef LUCARNE_GLOSSY
            sum.specular += specular_light[index].xyz;
#endif
        }
        ivec2 pane = (nearest + 2 * n) % n;
        if (!found) missing |= 1u << (pane.y * n + pane.x);
    }
    for (; missing != 0u; missing &= missing - 1u) {
        Gathered anew = gather_pane(receiver, uint(findLSB(missing)));
        sum.irradiance += anew.irradiance;
        sum.specular += anew.specular;
    }
    float panes = float(n * n);
    return Gathered(sum.irradiance / panes, sum.specular / panes);
}
