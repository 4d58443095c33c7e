// Gathers light at points: draws the tree of surfels into a small picture of the half space above each point, one
// work-item a point. Ritschel et al. 2009, "Micro-rendering for scalable, parallel final gathering", section 2.2.
//
// A pixel is a ray, and a disc covers it if the ray meets the disc. The picture is the unit disc on which directions
// are projected along the normal (Nusselt), so that equal areas of it are equal shares of the irradiance: a square of
// LUCARNE_GRID pixels a side about it, in rows of LUCARNE_ROW, which leave room for vectors of eight behind the last
// pixel.
#include "gi/gather/gather_point.h"
#include "gi/shared/lobe.h"
#include "gi/gather/sky_picture.h"
#include "gi/tree/wide_node.h"

#define GRID LUCARNE_GRID
#define ROW LUCARNE_ROW
#define PIXELS (GRID * ROW)
// Nodes are opened if their radius over their distance is larger. With buffers of 24^2 whole nodes are four pixels
// across: rows of eight pixels cost as much as one, so smaller ones would only add work. Clouds are opened further, and
// so are surfaces whose discs might appear half a pixel from where they are.
#define LARGEST fmin(4.0f / GRID, 0.2f)
#define THICKEST (0.7f / GRID)
#define LARGEST_THICK fmin(2.0f / GRID, 0.1f)
#define MOST_SMALL 4  // pixels along a side of what is drawn together with its neighbours
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

// The first of these numbers.
float fraction_of(uint seed) {
    seed ^= seed >> 16;
    seed *= 0x7feb352du;
    seed ^= seed >> 15;
    seed *= 0x846ca68bu;
    seed ^= seed >> 16;
    return convert_float(seed >> 8) * 0x1p-24f;
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

// Returns the slot of the first surfel that a ray meets up to the distance `most`, which becomes its distance; EMPTY
// if there is none.
uint first_surfel(global const WideNode* nodes, float3 from, float3 direction, float* most) {
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
        int8 near = (beside <= bound * bound * 1.0001f) & (along > -bound) & (along < *most + bound);
        int8 go = near & (child >= 0);
        top = push(go, child, stack, top);
        int8 leaf = near & (child == (int8)(kLeafChild));
        if (!any_of(leaf)) continue;
        float8 nx = vload8(0, node->nx), ny = vload8(0, node->ny), nz = vload8(0, node->nz);
        float8 distance = (dx * nx + dy * ny + dz * nz) / (direction.x * nx + direction.y * ny + direction.z * nz);
        float8 ox = direction.x * distance - dx, oy = direction.y * distance - dy, oz = direction.z * distance - dz;
        int8 met = leaf & (distance > 0.0f) & (ox * ox + oy * oy + oz * oz <= bound * bound);
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
    uint hides = first_surfel(nodes, start, viewer, &distance);
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

// Returns whether points of a node's plane, relative to its middle, are in parts of its box that its mask has.
int8 hidden(uint mask_low, uint mask_high, float3 axis, float3 low, float3 high, float8 x, float8 y, float8 z) {
    float3 size = fabs(axis), scale = 8.0f / (high - low);
    float8 i, j;
    if (size.x >= size.y && size.x >= size.z) {
        i = (y - low.y) * scale.y;
        j = (z - low.z) * scale.z;
    } else if (size.y >= size.z) {
        i = (z - low.z) * scale.z;
        j = (x - low.x) * scale.x;
    } else {
        i = (x - low.x) * scale.x;
        j = (y - low.y) * scale.y;
    }
    uint8 bit = convert_uint8_sat(fmin(i, 7.0f)) + 8u * convert_uint8_sat(fmin(j, 7.0f));
    uint8 word = select((uint8)(mask_low), (uint8)(mask_high), bit >= 32u);
    return ((word >> (bit & 31u)) & 1u) != 0u;
}

// The directions of all pixels, zero where a pixel has no ray.
typedef struct {
    float rows[3 * PIXELS];  // all x, all y, all z
    float4 each[PIXELS + MOST_SMALL * (ROW + 1)];  // what is drawn side by side may reach beyond the last
} Rays;

// Eight children of a node, as they appear from a place.
typedef struct {
    float8 dx, dy, dz;                 // middles, from the start of the rays
    float8 nx, ny, nz, plane;          // their planes: n . p = plane
    int8 cloud;
    int8 left, right, upper, lower;    // the pixels that they may cover
} Children;

int largest_of(int8 v) {
    int4 four = max(v.lo, v.hi);
    int2 two = max(four.lo, four.hi);
    return max(two.x, two.y);
}

// Draws one of eight children, which covers many pixels: eight of a row at a time.
void draw_large(global const WideNode* node, Children* children, int k, uint slot, const float* rays, uint seed,
                float* depths, uint* slots) {
    float x = ((float*)&children->dx)[k], y = ((float*)&children->dy)[k], z = ((float*)&children->dz)[k];
    float3 axis = (float3)(((float*)&children->nx)[k], ((float*)&children->ny)[k], ((float*)&children->nz)[k]);
    float plane = ((float*)&children->plane)[k];
    int first = ((int*)&children->left)[k], last = ((int*)&children->right)[k], end = ((int*)&children->lower)[k];
    float radius2 = node->bound[k] * node->bound[k];
    float3 low = (float3)(node->low_x[k], node->low_y[k], node->low_z[k]);
    float3 high = (float3)(node->high_x[k], node->high_y[k], node->high_z[k]);
    uint mask_low = node->mask_low[k], mask_high = node->mask_high[k];
    bool whole = (mask_low & mask_high) == 0xffffffffu, scattered = high.x == kCloud;
    float part = low.x;
    if (scattered) low = (float3)(-NOTHING), high = (float3)(NOTHING);
    for (int j = ((int*)&children->upper)[k]; j <= end; ++j)
        for (int i = first; i <= last; i += 8) {
            int pixel = j * ROW + i;
            float8 rx = vload8(0, rays + pixel), ry = vload8(0, rays + PIXELS + pixel);
            float8 rz = vload8(0, rays + 2 * PIXELS + pixel);
            float8 t = plane / (rx * axis.x + ry * axis.y + rz * axis.z);
            float8 ox = rx * t - x, oy = ry * t - y, oz = rz * t - z;
            float8 depth = vload8(0, depths + pixel);
            uint8 held = vload8(0, slots + pixel);
            int8 met = (t > 0.0f) & ((t < depth) | ((t == depth) & (held > slot)));
            met &= (ox >= low.x) & (ox <= high.x) & (oy >= low.y) & (oy <= high.y);
            met &= (oz >= low.z) & (oz <= high.z) & (ox * ox + oy * oy + oz * oz <= radius2);
            if (scattered)
                met &= fractions_of(slot * 0x9e3779b9u + seed + (uint)pixel) < part;
            else if (!whole)
                met &= hidden(mask_low, mask_high, axis, low, high, ox, oy, oz);
            vstore8(select(depth, t, met), 0, depths + pixel);
            vstore8(select(held, (uint8)(slot), met), 0, slots + pixel);
        }
}

// Draws those of eight children that cover few pixels: one pixel of each at a time. Most rays pass beside them, so what
// is left to do for those that do not is done for each by itself.
void draw_small(global const WideNode* node, Children* children, int8 small, uint first_slot, const float4* rays,
                uint seed, float* depths, uint* slots) {
    float8 dx = children->dx, dy = children->dy, dz = children->dz;
    float8 nx = children->nx, ny = children->ny, nz = children->nz, plane = children->plane;
    float8 radius = vload8(0, node->bound), radius2 = radius * radius;
    float8 low_x = select(vload8(0, node->low_x), (float8)(-NOTHING), children->cloud);
    float8 low_y = select(vload8(0, node->low_y), (float8)(-NOTHING), children->cloud);
    float8 low_z = select(vload8(0, node->low_z), (float8)(-NOTHING), children->cloud);
    float8 high_x = select(vload8(0, node->high_x), (float8)(NOTHING), children->cloud);
    float8 high_y = select(vload8(0, node->high_y), (float8)(NOTHING), children->cloud);
    float8 high_z = select(vload8(0, node->high_z), (float8)(NOTHING), children->cloud);
    int8 width = select((int8)(0), children->right - children->left + 1, small);
    int8 height = select((int8)(0), children->lower - children->upper + 1, small);
    int most_wide = largest_of(width), most_tall = largest_of(height);
    int corners[8];
    vstore8(select((int8)(0), children->upper * ROW + children->left, small), 0, corners);
    for (int j = 0; j < most_tall; ++j)
        for (int i = 0; i < most_wide; ++i) {
            const float4* pixel = rays + (j * ROW + i);
            float4 r0 = pixel[corners[0]], r1 = pixel[corners[1]], r2 = pixel[corners[2]], r3 = pixel[corners[3]];
            float4 r4 = pixel[corners[4]], r5 = pixel[corners[5]], r6 = pixel[corners[6]], r7 = pixel[corners[7]];
            float8 rx = (float8)(r0.x, r1.x, r2.x, r3.x, r4.x, r5.x, r6.x, r7.x);
            float8 ry = (float8)(r0.y, r1.y, r2.y, r3.y, r4.y, r5.y, r6.y, r7.y);
            float8 rz = (float8)(r0.z, r1.z, r2.z, r3.z, r4.z, r5.z, r6.z, r7.z);
            float8 t = plane / (rx * nx + ry * ny + rz * nz);
            float8 ox = rx * t - dx, oy = ry * t - dy, oz = rz * t - dz;
            // Few comparisons: each costs more than arithmetic.
            float8 room = LEAST(LEAST(ox - low_x, high_x - ox), LEAST(oy - low_y, high_y - oy));
            room = LEAST(room, LEAST(oz - low_z, high_z - oz));
            float8 most = select((float8)(-1.0f), radius2, (width > i) & (height > j));
            int8 met = (ox * ox + oy * oy + oz * oz <= most) & (room >= 0.0f) & (t > 0.0f);
            if (!any_of(met)) continue;
            int meets[8];
            float ts[8], xs[8], ys[8], zs[8];
            vstore8(met, 0, meets);
            vstore8(t, 0, ts);
            vstore8(ox, 0, xs);
            vstore8(oy, 0, ys);
            vstore8(oz, 0, zs);
            for (int k = 0; k < 8; ++k) {
                if (!meets[k]) continue;
                int at = corners[k] + j * ROW + i;
                uint slot = first_slot + (uint)k;
                if (ts[k] > depths[at] || (ts[k] == depths[at] && slots[at] < slot)) continue;
                if (node->high_x[k] == kCloud) {
                    if (fraction_of(slot * 0x9e3779b9u + seed + (uint)at) >= node->low_x[k]) continue;
                } else if (!hides(node, k, xs[k], ys[k], zs[k])) {
                    continue;
                }
                depths[at] = ts[k];
                slots[at] = slot;
            }
        }
}

// Draws everything above the plane through `start` into the picture: for each pixel the distance of the nearest disc
// and its slot. `side` and `across` are the axes of the picture, which reaches to `scale` along them; `rays` are the
// directions of its pixels, zero where a pixel has no ray.
void draw(global const WideNode* nodes, const Rays* rays, float3 start, float3 side, float3 across, float3 axis,
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
        children.cloud = cloud;
        children.left = convert_int8(fmax(ceil(px - wide), 0.0f));
        children.right = convert_int8(fmin(floor(px + wide), GRID - 1.0f));
        children.upper = convert_int8(fmax(ceil(py - tall), 0.0f));
        children.lower = convert_int8(fmin(floor(py + tall), GRID - 1.0f));
        int8 columns = children.right - children.left + 1, rows = children.lower - children.upper + 1;
        drawn &= (columns > 0) & (rows > 0);
        int8 small = drawn & (columns <= MOST_SMALL) & (rows <= MOST_SMALL);
        if (any_of(small)) draw_small(node, &children, small, (uint)at * 8, rays->each, seed, depths, slots);
        int8 others = drawn & ~small;
        if (!any_of(others)) continue;
        int draws[8];
        vstore8(others, 0, draws);
        for (int k = 0; k < 8; ++k)
            if (draws[k]) draw_large(node, &children, k, (uint)(at * 8 + k), rays->rows, seed, depths, slots);
    }
}

// Returns the slot whose light the surface receives from a direction. Rays start above the surface to clear its noise,
// and so would see everything from too near. Therefore the light is that of the point where the line from the surface
// itself meets the plane of the disc; the pixel that shows that point knows its slot. `lifted`: from the surface to
// the start, along the axes of the picture.
uint seen_slot(global const WideNode* nodes, const uint* slots, uint slot, float depth, float3 ray, float3 direction,
               float3 lifted, float3 position, float lift, float scale) {
    float3 axis = slot_axis(nodes, slot);
    float straight = dot(axis, slot_middle(nodes, slot) - position) / dot(axis, direction);
    if (!(straight > 0.0f) || fabs(straight - depth) > MOST_SHIFT * lift) return slot;
    float3 seen = ray * straight - lifted;
    if (!(seen.z > 0.0f)) return slot;
    float pixels = rsqrt(dot(seen, seen)) * (0.5f * GRID / scale);
    int i = clamp((int)(seen.x * pixels + 0.5f * GRID), 0, GRID - 1);
    int j = clamp((int)(seen.y * pixels + 0.5f * GRID), 0, GRID - 1);
    uint other = slots[j * ROW + i];
    if (other == EMPTY || other == slot) return slot;
    // It has to be the same surface, not what stands beside it.
    float3 point = position + direction * straight;
    float away = fabs(dot(slot_axis(nodes, other), point - slot_middle(nodes, other)));
    float allowed = 2.0f * lift + nodes[other / 8].thickness[other % 8];
    return away <= allowed ? other : slot;
}

// A micro-buffer's place: its start, the axes of its picture, and its set of rays, x and y of all pixels in the unit
// disc; x is over 1 where a pixel has no ray.
typedef struct {
    float3 position, normal, start, side, across, axis;
    float scale;
    global const float* set;
} Place;

// `rays`: sets of x and y of all pixels.
Place place_of(global const WideNode* nodes, GatherPoint point, global const float* rays, uint sets) {
    Place place;
    place.position = (float3)(point.position.x, point.position.y, point.position.z);
    place.normal = (float3)(point.normal.x, point.normal.y, point.normal.z);
    place.start = start_of(nodes, point);
    place.axis = (float3)(point.axis.x, point.axis.y, point.axis.z);
    place.scale = point.scale;
    float3 axis = place.axis;
    float angle = 6.28318531f * fractions_of(point.seed).s0;
    float3 u = normalize(cross(fabs(axis.x) > 0.5f ? (float3)(0, 1, 0) : (float3)(1, 0, 0), axis));
    place.side = cos(angle) * u + sin(angle) * cross(axis, u);
    place.across = cross(axis, place.side);
    place.set = rays + (point.seed % sets) * (2 * PIXELS);
    return place;
}

// Returns the ray of a pixel along the axes of the picture.
float3 ray_of(Place place, int pixel) {
    float x = place.set[pixel] * place.scale, y = place.set[PIXELS + pixel] * place.scale;
    return (float3)(x, y, sqrt(fmax(1.0f - x * x - y * y, 0.0f)));
}

// Sets the directions of all pixels, zero where there is none above the surface, and an empty picture.
void clear(Place place, Rays* directions, float* depths, uint* slots) {
    for (int i = 0; i < PIXELS; i += 8) {
        float8 x = vload8(0, place.set + i), y = vload8(0, place.set + PIXELS + i);
        int8 none = x > 1.0f;
        x *= place.scale;
        y *= place.scale;
        float8 z = sqrt(fmax(1.0f - x * x - y * y, 0.0f));
        float8 dx = place.side.x * x + place.across.x * y + place.axis.x * z;
        float8 dy = place.side.y * x + place.across.y * y + place.axis.y * z;
        float8 dz = place.side.z * x + place.across.z * y + place.axis.z * z;
        none |= dx * place.normal.x + dy * place.normal.y + dz * place.normal.z <= 0.0f;
        dx = select(dx, (float8)(0.0f), none);
        dy = select(dy, (float8)(0.0f), none);
        dz = select(dz, (float8)(0.0f), none);
        vstore8(dx, 0, directions->rows + i);
        vstore8(dy, 0, directions->rows + PIXELS + i);
        vstore8(dz, 0, directions->rows + 2 * PIXELS + i);
        for (int k = 0; k < 8; ++k)
            directions->each[i + k] = (float4)(((float*)&dx)[k], ((float*)&dy)[k], ((float*)&dz)[k], 0.0f);
        vstore8((float8)(NOTHING), 0, depths + i);
        vstore8((uint8)(EMPTY), 0, slots + i);
    }
    for (int i = 0; i < MOST_SMALL * (ROW + 1); ++i) directions->each[PIXELS + i] = (float4)(0.0f);
}

// Draws what is above a place.
void draw_place(global const WideNode* nodes, Place place, uint seed, Rays* directions, float* depths, uint* slots) {
    clear(place, directions, depths, slots);
    draw(nodes, directions, place.start, place.side, place.across, place.axis, place.normal, place.scale, seed, depths,
         slots);
}

// Returns the side that a pixel sees, twice the slot and one more for the back, if it sees any.
uint seen_side(global const WideNode* nodes, Place place, const uint* slots, const float* depths, int pixel,
               float3 ray, float3 direction, float lift) {
    float3 away = place.start - place.position;
    float3 lifted = (float3)(dot(away, place.side), dot(away, place.across), dot(away, place.axis));
    uint slot = seen_slot(nodes, slots, slots[pixel], depths[pixel], ray, direction, lifted, place.position, lift,
                          place.scale);
    // The start sees the side of the plane on which it is.
    uint back = dot(slot_axis(nodes, slot), slot_middle(nodes, slot) - place.start) < 0.0f ? 0u : 1u;
    return 2 * slot + back;
}

// Returns the specular light of a side in a direction, W/(sr m^2).
float3 specular(global const float* light, global const float* directions, uint side, float3 to) {
    float3 sent = vload3(side, light);
    return sent.x + sent.y + sent.z > 0.0f ? sent * lobe_radiance(sent, vload3(side, directions), to) : (float3)(0.0f);
}

float3 sky_radiance(global const float* texels, SkyPicture sky, float3 direction) {
    vec2 place = environment_place(direction, sky.rotation);
    uint x = min((uint)(place.x * sky.width), sky.width - 1u), y = min((uint)(place.y * sky.height), sky.height - 1u);
    return vload3(y * sky.width + x, texels);
}

// For each point: the mean radiance of its rays, W/(sr m^2) (times pi: irradiance), and the share of rays that meet
// nothing. `light`: six floats a slot, the radiance of its front and of its back; lit = 0: `nodes` only block.
// `lobe_light` and `lobe_directions`, likewise: what it sends out by specular lobes, if glossy is not 0. `sky` shines
// where there is nothing; without texels it is dark.
kernel void gather(global const WideNode* nodes, global const float* light, uint lit, global const float* lobe_light,
                   global const float* lobe_directions, uint glossy, global const float* sky_texels, SkyPicture sky,
                   global const GatherPoint* points, global const float* rays, uint sets, uint count,
                   global float4* results) {
    uint number = get_global_id(0);
    if (number >= count) return;
    GatherPoint point = points[number];
    Place place = place_of(nodes, point, rays, sets);
    Rays directions;
    float depths[PIXELS];
    uint slots[PIXELS];
    draw_place(nodes, place, point.seed, &directions, depths, slots);

    float3 sum = (float3)(0.0f);
    uint cast = 0, empty = 0;
    for (int j = 0; j < GRID; ++j)
        for (int i = 0; i < GRID; ++i) {
            int pixel = j * ROW + i;
            if (place.set[pixel] > 1.0f) continue;
            ++cast;
            float3 direction = directions.each[pixel].xyz;
            float height = dot(direction, place.normal);
            if (!(height > 0.0f)) continue;
            float3 ray = ray_of(place, pixel);
            float weight = point.exponent > 0.0f ? pow(ray.z, point.exponent - 1.0f) * height : 1.0f;
            if (slots[pixel] == EMPTY) {
                ++empty;
                if (sky.width > 0) sum += weight * sky_radiance(sky_texels, sky, direction);
            } else if (lit) {
                uint side = seen_side(nodes, place, slots, depths, pixel, ray, direction, point.lift);
                sum += weight * vload3(side, light);
                if (glossy) sum += weight * specular(lobe_light, lobe_directions, side, -direction);
            }
        }
    results[number] = (float4)(sum / cast, (float)(empty) / cast);
}

// Sets what each pixel of the buffers of `count` points from `first` on sees: a side (seen_side), kSeesSky or
// kSeesNothing, GRID * GRID for each point; and the mean of 1 over the distance, 1/m.
kernel void see(global const WideNode* nodes, global const GatherPoint* points, global const float* rays, uint sets,
                uint first, uint count, global uint* seen, global float* nearness) {
    uint number = get_global_id(0);
    if (number >= count) return;
    number += first;
    GatherPoint point = points[number];
    Place place = place_of(nodes, point, rays, sets);
    Rays directions;
    float depths[PIXELS];
    uint slots[PIXELS];
    draw_place(nodes, place, point.seed, &directions, depths, slots);

    global uint* sees = seen + number * (uint)(GRID * GRID);
    float near = 0.0f;
    uint cast = 0;
    for (int j = 0; j < GRID; ++j)
        for (int i = 0; i < GRID; ++i) {
            int pixel = j * ROW + i;
            float3 direction = directions.each[pixel].xyz;
            uint code = kSeesNothing;
            if (place.set[pixel] <= 1.0f && dot(direction, place.normal) > 0.0f) {
                ++cast;
                code = kSeesSky;
                if (slots[pixel] != EMPTY) {
                    near += 1.0f / fmax(depths[pixel], 1e-6f);
                    code = seen_side(nodes, place, slots, depths, pixel, ray_of(place, pixel), direction, point.lift);
                }
            }
            sees[j * GRID + i] = code;
        }
    nearness[number] = cast > 0 ? near / cast : 0.0f;
}

// For each point: the light that it receives by what its buffer sees, as the ten terms of a LightByNormal (three floats
// each). At the point's own normal it is the mean over the rays, as gather() has it. What changes with the normal is that
// of the spherical harmonics up to the second order (Ramamoorthi & Hanrahan 2001, "An efficient representation for
// irradiance environment maps"): they turn max(c, 0), c the cosine between normal and ray, into 3/32 + c/2 + 15/32 c^2.
// Arguments as above.
kernel void shade(global const WideNode* nodes, global const float* light, uint lit, global const float* lobe_light,
                  global const float* lobe_directions, uint glossy, global const float* sky_texels, SkyPicture sky,
                  global const GatherPoint* points, global const float* rays, uint sets, uint count,
                  global const uint* seen, global float* results) {
    uint number = get_global_id(0);
    if (number >= count) return;
    GatherPoint point = points[number];
    point.viewer.x = point.viewer.y = point.viewer.z = 0.0f;  // the start of the rays does not matter any more
    Place place = place_of(nodes, point, rays, sets);
    float3 sum = (float3)(0.0f), terms[9];
    for (int k = 0; k < 9; ++k) terms[k] = (float3)(0.0f);
    uint cast = 0;
    for (int j = 0; j < GRID; ++j)
        for (int i = 0; i < GRID; ++i) {
            uint code = seen[number * (uint)(GRID * GRID) + (uint)(j * GRID + i)];
            if (code == kSeesNothing) continue;
            ++cast;
            float3 ray = ray_of(place, j * ROW + i);
            float3 d = place.side * ray.x + place.across * ray.y + place.axis * ray.z;
            float3 radiance = (float3)(0.0f);
            if (code != kSeesSky) {
                if (lit) radiance = vload3(code, light);
                if (glossy) radiance += specular(lobe_light, lobe_directions, code, -d);
            } else if (sky.width > 0) {
                radiance = sky_radiance(sky_texels, sky, d);
            }
            sum += radiance;
            // Rays are drawn by the cosine, so each stands for as much solid angle as 1 over its cosine; within the
            // last six degrees above the horizon that would be beyond bounds, and stays as it is there.
            float3 weighted = radiance / fmax(ray.z, 0.1f);
            float3 linear = 0.5f * weighted, squares = 0.46875f * weighted;
            terms[0] += linear * d.x;
            terms[1] += linear * d.y;
            terms[2] += linear * d.z;
            terms[3] += squares * (d.x * d.x);
            terms[4] += squares * (d.y * d.y);
            terms[5] += squares * (d.z * d.z);
            terms[6] += squares * (2.0f * d.x * d.y);
            terms[7] += squares * (2.0f * d.y * d.z);
            terms[8] += squares * (2.0f * d.z * d.x);
        }
    float share = cast > 0 ? 1.0f / cast : 0.0f;
    float3 n = place.axis;
    float powers[9] = {n.x, n.y, n.z, n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x};
    for (int k = 0; k < 9; ++k) {
        sum -= powers[k] * terms[k];
        vstore3(terms[k] * share, 10 * number + k + 1, results);
    }
    vstore3(sum * share, 10 * number, results);
}
