// Draws a triangle into every slice that it meets, 3 vertices each; the fragment shader discards what lies in other
// slices (Gaitatzes 2012, algorithm 6).
#include "gi/volume/triangles/sweep_axis.glsl"

layout(triangle_strip, max_vertices = VERTICES) out;

void main() {
    vec3 normal = area_vector();
    if (!is_swept(normal)) return;
    vec3 a = turned(place[0]), b = turned(place[1]), c = turned(place[2]);
    int first = slice_of(min(a.z, min(b.z, c.z))) + first_slice;
    int last = min(slice_of(max(a.z, max(b.z, c.z))), first + slice_count - 1);
    last = min(last, first + VERTICES / 3 - 1);
    for (int layer = first; layer <= last; ++layer) {
        emit(normal, a, albedo[0], layer);
        emit(normal, b, albedo[1], layer);
        emit(normal, c, albedo[2], layer);
        EndPrimitive();
    }
}
