// Cuts a triangle into strips, one for each slice of the volume, and draws each into its layer (Gaitatzes 2012,
// algorithm 5). A strip is the part between two depths; it has a corner on the longest edge (from the nearest corner to
// the farthest) and one on the two others at either depth. The second corner's depth divides the strip of its slice in
// two (case F there). 3 + 4 n vertices for n cuts.
#include "gi/volume/triangles/sweep_axis.glsl"

layout(triangle_strip, max_vertices = VERTICES) out;

struct Corner {
    vec3 at, albedo;
};
Corner between(Corner a, Corner b, float z) {
    float t = b.at.z > a.at.z ? clamp((z - a.at.z) / (b.at.z - a.at.z), 0.0, 1.0) : 0.0;
    Corner corner = Corner(mix(a.at, b.at, t), mix(a.albedo, b.albedo, t));
    return corner;
}

void main() {
    vec3 normal = area_vector();
    if (!is_swept(normal)) return;
    Corner c[3];
    for (int i = 0; i < 3; ++i) c[i] = Corner(turned(place[i]), albedo[i]);
    Corner kept;
    if (c[0].at.z > c[1].at.z) { kept = c[0]; c[0] = c[1]; c[1] = kept; }
    if (c[1].at.z > c[2].at.z) { kept = c[1]; c[1] = c[2]; c[2] = kept; }
    if (c[0].at.z > c[1].at.z) { kept = c[0]; c[0] = c[1]; c[1] = kept; }
    int lowest = slice_of(c[0].at.z), highest = slice_of(c[2].at.z);
    int left = VERTICES;
    int first = lowest + first_slice, last = min(highest, first + slice_count - 1);
    if (lowest == highest && first == lowest) {
        if (left < 3) return;
        for (int i = 0; i < 3; ++i) emit(normal, c[i].at, c[i].albedo, lowest);
        return;
    }
    for (int layer = first; layer <= last; ++layer) {
        float low = layer == lowest ? c[0].at.z : float(layer);
        float high = layer == highest ? c[2].at.z : float(layer + 1);
        bool divided = low < c[1].at.z && c[1].at.z < high;
        for (int part = 0; part < (divided ? 2 : 1); ++part) {
            float from = part == 1 ? c[1].at.z : low, to = divided && part == 0 ? c[1].at.z : high;
            bool upper = from >= c[1].at.z;  // beside the edge from the second corner to the third
            Corner a = between(c[0], c[2], from), b = upper ? between(c[1], c[2], from) : between(c[0], c[1], from);
            Corner d = between(c[0], c[2], to), e = upper ? between(c[1], c[2], to) : between(c[0], c[1], to);
            // A tip has one corner; so has no triangle a strip of four.
            bool begins = from <= c[0].at.z && c[1].at.z > c[0].at.z;
            bool ends = to >= c[2].at.z && c[1].at.z < c[2].at.z;
            int needed = begins || ends ? 3 : 4;
            if (left < needed) return;
            left -= needed;
            emit(normal, a.at, a.albedo, layer);
            if (!begins) emit(normal, b.at, b.albedo, layer);
            emit(normal, d.at, d.albedo, layer);
            if (!ends) emit(normal, e.at, e.albedo, layer);
            EndPrimitive();
        }
    }
}
