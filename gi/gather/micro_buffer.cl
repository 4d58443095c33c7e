// Draws the tree of surfels into a micro-buffer, a small picture of the half space above a point (gather.cl).
#include "gi/gather/gather_point.h"
#include "gi/tree/wide_node.h"

#define GRID LUCARNE_GRID
#define ROW LUCARNE_ROW
#define PIXELS (GRID * ROW)
#define RAYS ((GRID + 1) * ROW)  // with a row of room below the last, for what is drawn two rows at a time
// Nodes are opened if their radius over their distance is larger. With buffers of 24^2 whole nodes are four pixels
// across: eight pixels cost as much as one, so smaller ones would only add work. Clouds are opened further, and
// so are surfaces whose discs might appear half a pixel from where they are.
#if LUCARNE_FILL_PIXELS
#define LARGEST (1.0f / GRID)
#define LARGEST_THICK LARGEST
#else
#define LARGEST fmin(4.0f / GRID, 0.2f)
#define LARGEST_THICK fmin(2.0f / GRID, 0.1f)
#endif
#define THICKEST (0.7f / GRID)
#define FEW_COLUMNS 4  // what they hold is drawn two rows at a time
#define STACK 456  // seven a level; trees of 2^32 surfels have at most 64 levels (kMedianLevel)
#define EMPTY 0xffffffffu
#define NOTHING 1e30f
#define MOST_SHIFT 4.0f  // in lifts, see seen_slot()

// As fmin() where neither is NaN, in one instruction.
#define LEAST(a, b) select(b, a, (a) < (b))

// As any() for the result of a comparison, without a branch for each number.
bool any_of(int8 met) {
    ulong4 pairs = as_ulong4(met);
    ulong2 two = pairs.lo | pairs.hi;
    return (two.x | two.y) != 0;
}

// Numbers from 0 to 1 for a number and the seven that follow it.
float8 fractions_of(uint first) {
    uint8 seeds = first + (uint8)(0, 1, 2, 3, 4, 5, 6, 7);
    seeds ^= seeds >> 16;
    seeds *= 0x7feb352du;
    seeds ^= seeds >> 15;
    seeds *= 0x846ca68bu;
    seeds ^= seeds >> 16;
    return convert_float8(seeds >> 8) * 0x1p-24f;
}

// Pushes those children for which `go` is set; returns the new height of the stack.
int push(int8 go, int8 child, int* stack, int top) {
    if (!any_of(go)) return top;
    int goes[8], children[8];
    vstore8(go, 0, goes);
    vstore8(child, 0, children);
    for (int k = 0; k < 8; ++k) {
        stack[top] = children[k];
        top += goes[k] != 0;
    }
    return top;
}

float3 slot_middle(global const WideNode* nodes, uint slot) {
    global const WideNode* node = nodes + slot / 8;
    uint k = slot % 8;
    return (float3)(node->x[k], node->y[k], node->z[k]);
}
float3 slot_axis(global const WideNode* nodes, uint slot) {
    global const WideNode* node = nodes + slot / 8;
    uint k = slot % 8;
    return (float3)(node->nx[k], node->ny[k], node->nz[k]);
}

// Returns the slot of the first surfel that a ray meets beyond the distance `least` and up to `most`, which becomes its
// distance; EMPTY if there is none.
uint first_surfel(global const WideNode* nodes, float3 from, float3 direction, float least, float* most) {
    int stack[STACK];
    int top = 0;
    uint found = EMPTY;
    stack[top++] = 0;
    while (top > 0) {
        int at = stack[--top];
        global const WideNode* node = nodes + at;
        float8 dx = vload8(0, node->x) - from.x, dy = vload8(0, node->y) - from.y, dz = vload8(0, node->z) - from.z;
        float8 bound = vload8(0, node->bound);
        int8 child = vload8(0, node->child);
        float8 along = dx * direction.x + dy * direction.y + dz * direction.z;
        float8 beside = dx * dx + dy * dy + dz * dz - along * along;
        int8 near = (beside <= bound * bound * 1.0001f) & (along > least - bound) & (along < *most + bound);
        int8 go = near & (child >= 0);
        top = push(go, child, stack, top);
        int8 leaf = near & (child == (int8)(kLeafChild));
        if (!any_of(leaf)) continue;
        float8 nx = vload8(0, node->nx), ny = vload8(0, node->ny), nz = vload8(0, node->nz);
        float8 distance = (dx * nx + dy * ny + dz * nz) / (direction.x * nx + direction.y * ny + direction.z * nz);
        float8 ox = direction.x * distance - dx, oy = direction.y * distance - dy, oz = direction.z * distance - dz;
        int8 met = leaf & (distance > least) & (ox * ox + oy * oy + oz * oz <= bound * bound);
        if (!any_of(met)) continue;
        int meets[8];
        float distances[8];
        vstore8(met, 0, meets);
        vstore8(distance, 0, distances);
        for (int k = 0; k < 8; ++k) {
            uint slot = (uint)(at * 8 + k);
            if (!meets[k] || distances[k] > *most || (distances[k] == *most && slot > found)) continue;
            *most = distances[k];
            found = slot;
        }
    }
    return found;
}

// Returns where rays start, `lift` above the surface. The picture may show the rim of a disc that lies a little behind
// another surface (kRimPush). Rays have to start on the viewer's side of that surface, or the rims of a sealed room
// would be lit from outside.
float3 start_of(global const WideNode* nodes, GatherPoint point) {
    float3 position = (float3)(point.position.x, point.position.y, point.position.z);
    float3 normal = (float3)(point.normal.x, point.normal.y, point.normal.z);
    float3 viewer = (float3)(point.viewer.x, point.viewer.y, point.viewer.z);
    float3 start = position + normal * point.lift;
    if (dot(viewer, viewer) == 0.0f) return start;
    float distance = 8.0f * point.lift;
    uint hides = first_surfel(nodes, start, viewer, 0.0f, &distance);
    if (hides == EMPTY) return start;
    float radius = nodes[hides / 8].bound[hides % 8];
    if (distance > 2.0f * fmax(point.lift, radius)) return start;  // another object in front of it
    float3 axis = slot_axis(nodes, hides);
    return start + viewer * distance + axis * (dot(axis, viewer) > 0.0f ? radius : -radius);
}

// Returns whether a point of the plane of a node's child, relative to its middle, is in a part of its box that its mask
// has.
bool hides(global const WideNode* node, int k, float x, float y, float z) {
    uint low = node->mask_low[k], high = node->mask_high[k];
    if ((low & high) == 0xffffffffu) return true;
    float size_x = fabs(node->nx[k]), size_y = fabs(node->ny[k]), size_z = fabs(node->nz[k]);
    float i = (x - node->low_x[k]) * (8.0f / (node->high_x[k] - node->low_x[k]));
    float j = (y - node->low_y[k]) * (8.0f / (node->high_y[k] - node->low_y[k]));
    float l = (z - node->low_z[k]) * (8.0f / (node->high_z[k] - node->low_z[k]));
    if (size_x >= size_y && size_x >= size_z) {
        i = j;
        j = l;
    } else if (size_y >= size_z) {
        j = i;
        i = l;
    }
    uint bit = convert_uint_sat(fmin(i, 7.0f)) + 8u * convert_uint_sat(fmin(j, 7.0f));
    return (((bit >= 32u ? high : low) >> (bit & 31u)) & 1u) != 0u;
}

// Returns the direction of a pixel. `rays`: x of all pixels, then all y, then all z; zero where a pixel has no ray.
float3 direction_of(const float* rays, int pixel) {
    return (float3)(rays[pixel], rays[RAYS + pixel], rays[2 * RAYS + pixel]);
}

// Eight children of a node, as they appear from a place.
typedef struct {
    float8 dx, dy, dz;                 // middles, from the start of the rays
    float8 nx, ny, nz, plane;          // their planes: n . p = plane
    int8 left, right, upper, lower;    // the pixels that they may cover
} Children;

// Lets a pixel show a child that its ray meets at the distance t, at a place relative to the child's middle, if the
// child hides that place and nothing nearer.
void show(global const WideNode* node, int k, uint slot, int pixel, float t, float x, float y, float z, uint seed,
          float* depths, uint* slots) {
    if (t > depths[pixel] || (t == depths[pixel] && slots[pixel] < slot)) return;
    if (node->high_x[k] == kCloud) {
        if (fractions_of(slot * 0x9e3779b9u + seed + (uint)pixel).s0 >= node->low_x[k]) return;
    } else if (!hides(node, k, x, y, z)) {
        return;
    }
    depths[pixel] = t;
    slots[pixel] = slot;
}

// Draws one of eight children: eight pixels at a time, of two rows if four columns hold it. Rays beyond the pixels that
// it may cover pass beside it.
void draw_child(global const WideNode* node, const Children* children, int k, uint slot, const float* rays, uint seed,
                float* depths, uint* slots) {
    float x = ((const float*)&children->dx)[k], y = ((const float*)&children->dy)[k];
    float z = ((const float*)&children->dz)[k], plane = ((const float*)&children->plane)[k];
    float nx = ((const float*)&children->nx)[k], ny = ((const float*)&children->ny)[k];
    float nz = ((const float*)&children->nz)[k];
    int left = ((const int*)&children->left)[k], right = ((const int*)&children->right)[k];
    int upper = ((const int*)&children->upper)[k], lower = ((const int*)&children->lower)[k];
    float radius2 = node->bound[k] * node->bound[k];
    float3 low = (float3)(node->low_x[k], node->low_y[k], node->low_z[k]);
    float3 high = (float3)(node->high_x[k], node->high_y[k], node->high_z[k]);
    if (high.x == kCloud) low = (float3)(-NOTHING), high = (float3)(NOTHING);
    bool narrow = right - left < FEW_COLUMNS;
    int other = narrow ? ROW : 4;  // where the second four of the eight pixels are, from the first four
    for (int j = upper; j <= lower; j += narrow ? 2 : 1)
        for (int i = left; i <= right; i += narrow ? FEW_COLUMNS : 8) {
            int pixel = j * ROW + i;
            const float *at_x = rays + pixel, *at_y = at_x + RAYS, *at_z = at_y + RAYS, *depth = depths + pixel;
            float8 rx = (float8)(vload4(0, at_x), vload4(0, at_x + other));
            float8 ry = (float8)(vload4(0, at_y), vload4(0, at_y + other));
            float8 rz = (float8)(vload4(0, at_z), vload4(0, at_z + other));
            float8 nearest = (float8)(vload4(0, depth), vload4(0, depth + other));
            float8 t = plane / (rx * nx + ry * ny + rz * nz);
            float8 ox = rx * t - x, oy = ry * t - y, oz = rz * t - z;
            // Few comparisons: each costs more than arithmetic.
            float8 room = LEAST(LEAST(ox - low.x, high.x - ox), LEAST(oy - low.y, high.y - oy));
            room = LEAST(room, LEAST(oz - low.z, high.z - oz));
            int8 met = (t > 0.0f) & (t <= nearest) & (ox * ox + oy * oy + oz * oz <= radius2) & (room >= 0.0f);
            if (!any_of(met)) continue;
            for (int lane = 0; lane < 8; ++lane)
                if (((int*)&met)[lane])
                    show(node, k, slot, pixel + (lane & 3) + (lane >> 2) * other, ((float*)&t)[lane],
                         ((float*)&ox)[lane], ((float*)&oy)[lane], ((float*)&oz)[lane], seed, depths, slots);
        }
}

// Draws each of eight children as the pixel at its middle, if that pixel has a ray: the paper's buffers without ray
// casting (fig. 11).
void fill_pixels(int8 drawn, int8 columns, int8 rows, float8 distances, uint first_slot, const float* rays,
                 float* depths, uint* slots) {
    for (int k = 0; k < 8; ++k) {
        int i = ((int*)&columns)[k], j = ((int*)&rows)[k], pixel = j * ROW + i;
        if (!((int*)&drawn)[k] || i < 0 || i >= GRID || j < 0 || j >= GRID) continue;
        float3 ray = direction_of(rays, pixel);
        float distance = ((float*)&distances)[k];
        uint slot = first_slot + (uint)k;
        bool nearest = distance < depths[pixel] || (distance == depths[pixel] && slot < slots[pixel]);
        if (dot(ray, ray) == 0.0f || !nearest) continue;
        depths[pixel] = distance;
        slots[pixel] = slot;
    }
}

// Draws everything above the plane through `start` into the picture: for each pixel the distance of the nearest disc
// and its slot. `side` and `across` are the axes of the picture, which reaches to `scale` along them; `rays` are the
// directions of its pixels, zero where a pixel has no ray.
void draw(global const WideNode* nodes, const float* rays, float3 start, float3 side, float3 across, float3 axis,
          float3 normal, float scale, uint seed, float* depths, uint* slots) {
    float pixels = 0.5f * GRID / scale;
    int stack[STACK];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        int at = stack[--top];
        global const WideNode* node = nodes + at;
        float8 dx = vload8(0, node->x) - start.x, dy = vload8(0, node->y) - start.y, dz = vload8(0, node->z) - start.z;
        float8 bound = vload8(0, node->bound), thickness = vload8(0, node->thickness);
        float8 nx = vload8(0, node->nx), ny = vload8(0, node->ny), nz = vload8(0, node->nz);
        int8 child = vload8(0, node->child);
        float8 height = dx * normal.x + dy * normal.y + dz * normal.z;
        float8 facing = nx * normal.x + ny * normal.y + nz * normal.z;
        float8 distance2 = dx * dx + dy * dy + dz * dz;
        // What the discs of the child rise above its middle: those of the point's own surface lie below the start.
        float8 rise = fmin(bound, bound * sqrt(fmax(1.0f - facing * facing, 0.0f)) + thickness);
        int8 above = (height > -rise) & (child != (int8)(kNoChild));
        float8 along = dx * axis.x + dy * axis.y + dz * axis.z;
        above &= along > -bound;
        // Spheres beside the cone that the picture shows: sin(a + b) <= sin a + sin b.
        if (scale < 1.0f)
            above &= distance2 - along * along <= (sqrt(distance2) * scale + bound) * (sqrt(distance2) * scale + bound);
        int8 cloud = vload8(0, node->high_x) == (float8)(kCloud);
        float8 plane = dx * nx + dy * ny + dz * nz;
        int8 thick = cloud | (thickness * thickness > distance2 * (THICKEST * THICKEST * scale * scale));
        float8 limit = select((float8)(LARGEST), (float8)(LARGEST_THICK), thick) * scale;
        int8 large = (bound * bound > distance2 * limit * limit) & (child >= 0);
        int8 go = above & large, drawn = above & ~large;
        top = push(go, child, stack, top);
        if (!any_of(drawn)) continue;
        float8 nearer = rsqrt(distance2);
        // The picture of the cone about a sphere: its directions are c u + s v with unit vectors v across u.
        float8 s = fmin(bound * nearer, 1.0f), c = sqrt(1.0f - s * s) * (0.5f * GRID / scale);
        float8 ux = (dx * side.x + dy * side.y + dz * side.z) * nearer;
        float8 uy = (dx * across.x + dy * across.y + dz * across.z) * nearer;
        float8 px = ux * c + (0.5f * GRID - 0.5f), py = uy * c + (0.5f * GRID - 0.5f);
#if LUCARNE_FILL_PIXELS
        fill_pixels(drawn, convert_int8_rte(px), convert_int8_rte(py), distance2 * nearer, (uint)at * 8, rays, depths,
                    slots);
        continue;
#endif
        float8 wide = s * sqrt(fmax(1.0f - ux * ux, 0.0f)) * pixels + 0.5f;
        float8 tall = s * sqrt(fmax(1.0f - uy * uy, 0.0f)) * pixels + 0.5f;
        // Cones about the end of an axis reach to its end.
        wide = select(wide, (float8)(2.0f * GRID), (s >= 1.0f) | (ux * ux + s * s > 1.0f));
        tall = select(tall, (float8)(2.0f * GRID), (s >= 1.0f) | (uy * uy + s * s > 1.0f));
        Children children;
        children.dx = dx;
        children.dy = dy;
        children.dz = dz;
        children.nx = select(nx, dx * nearer, cloud);
        children.ny = select(ny, dy * nearer, cloud);
        children.nz = select(nz, dz * nearer, cloud);
        children.plane = select(plane, distance2 * nearer, cloud);
        children.left = convert_int8(fmax(ceil(px - wide), 0.0f));
        children.right = convert_int8(fmin(floor(px + wide), GRID - 1.0f));
        children.upper = convert_int8(fmax(ceil(py - tall), 0.0f));
        children.lower = convert_int8(fmin(floor(py + tall), GRID - 1.0f));
        int8 columns = children.right - children.left + 1, rows = children.lower - children.upper + 1;
        drawn &= (columns > 0) & (rows > 0);
        int draws[8];
        vstore8(drawn, 0, draws);
        for (int k = 0; k < 8; ++k)
            if (draws[k]) draw_child(node, &children, k, (uint)(at * 8 + k), rays, seed, depths, slots);
    }
}
