// Draws the tree of surfels into micro-buffers, small pictures of the half spaces above points (gather.cl): those of
// LUCARNE_LANES points that lie close together at once, each in a lane of the vectors.
#include "gi/gather/gather_point.h"
#include "gi/tree/wide_node.h"

#define GRID LUCARNE_GRID
#define PIXELS (GRID * GRID)
// Nodes are opened if their radius over their distance is larger: with buffers of 24^2 whole nodes are four pixels
// across. Clouds are opened further, and so are surfaces whose discs might appear half a pixel from where they are.
#if LUCARNE_FILL_PIXELS
#define LARGEST (1.0f / GRID)
#define LARGEST_THICK LARGEST
#else
#define LARGEST fmin(4.0f / GRID, 0.2f)
#define LARGEST_THICK fmin(2.0f / GRID, 0.1f)
#endif
#define THICKEST (0.7f / GRID)
#define STACK 456  // seven a level; trees of 2^32 surfels have at most 64 levels (kMedianLevel)
#define EMPTY 0xffffffffu
#define NOTHING 1e30f
#define SLACK 1.003f  // for quick roots
#define MOST_SHIFT 4.0f  // in lifts, see seen_slot()

#define LANES LUCARNE_LANES
#if LANES == 8
typedef float8 Floats;
typedef int8 Flags;  // -1 or 0
typedef uint8 Numbers;
#define TO_FLOATS convert_float8
#define TO_NUMBERS convert_uint8
#else
typedef float Floats;
typedef int Flags;  // 1 or 0
typedef uint Numbers;
#define TO_FLOATS convert_float
#define TO_NUMBERS convert_uint
#endif
#define LANE(type, vector, lane) (((type*)&(vector))[lane])

// As fmin() and fmax() where neither is NaN, in one instruction.
#define LEAST(a, b) select(b, a, (a) < (b))
#define MOST(a, b) select(b, a, (a) > (b))

// As any() for the result of a comparison, without a branch for each number.
bool any_of(int8 met) {
    ulong4 pairs = as_ulong4(met);
    ulong2 two = pairs.lo | pairs.hi;
    return (two.x | two.y) != 0;
}
#if LANES == 8
#define ANY_LANE any_of
#else
#define ANY_LANE(flags) ((flags) != 0)
#endif

// Numbers from 0 to 1 for whole ones.
Floats fractions_of(Numbers seeds) {
    seeds ^= seeds >> 16;
    seeds *= 0x7feb352du;
    seeds ^= seeds >> 15;
    seeds *= 0x846ca68bu;
    seeds ^= seeds >> 16;
    return TO_FLOATS(seeds >> 8) * 0x1p-24f;
}

// Roots and 1 over them, at most 0.2 % too small: a guess from the bits, improved once (Lomont 2003, "Fast inverse
// square root"). Exact ones take several times as long, and what is drawn where only needs bounds.
#if LANES == 8
#define BITS_OF as_int8
#define OF_BITS as_float8
#else
#define BITS_OF as_int
#define OF_BITS as_float
#endif
Floats quick_rsqrt(Floats x) {
    Floats guess = OF_BITS(0x5f375a86 - (BITS_OF(x) >> 1));
    return guess * (1.5f - 0.5f * x * guess * guess);
}
// Of what is under zero: zero.
Floats quick_sqrt(Floats x) {
    Floats least = MOST(x, (Floats)(1e-12f));
    return least * quick_rsqrt(least);
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

// A pixel of the micro-buffers of all lanes.
typedef struct {
    Floats x, y, z;  // direction of the ray; zero where there is none
    Floats depth;    // of the nearest that was drawn, NOTHING if there is none
    Numbers side;    // twice the slot that was drawn, and one more for its back; EMPTY
} Pixel;

// Where the rays of the lanes start, the normals of their surfaces, and the axes of their pictures, which reach to
// `scale` along `side` and `across`.
typedef struct {
    Floats x, y, z, normal_x, normal_y, normal_z, axis_x, axis_y, axis_z;
    Floats side_x, side_y, side_z, across_x, across_y, across_z;
    Floats scale, pixels;  // a picture has so many pixels for 1 along `side` and `across`
    Numbers seed;
} Starts;

// Bounds of the lanes: their starts are within `radius` of the middle, and none is higher over its plane than `lifted`;
// normals and axes, as vectors, differ from the common ones by up to `turned` and `twisted`.
typedef struct {
    float3 middle, normal, axis;
    float radius, lifted, turned, twisted, least_scale, most_scale;
} Group;

float least_lane(Floats v) {
    float least = LANE(float, v, 0);
    for (int lane = 1; lane < LANES; ++lane) least = fmin(least, LANE(float, v, lane));
    return least;
}
float most_lane(Floats v) { return -least_lane(-v); }
float mean_lane(Floats v) {
    float sum = 0.0f;
    for (int lane = 0; lane < LANES; ++lane) sum += LANE(float, v, lane);
    return sum / LANES;
}
float most_length(Floats x, Floats y, Floats z) { return sqrt(most_lane(x * x + y * y + z * z)); }
// Returns a vector divided by its length, or the first lane's if that is near zero.
float3 common_direction(Floats x, Floats y, Floats z) {
    float3 mean = (float3)(mean_lane(x), mean_lane(y), mean_lane(z));
    float size = length(mean);
    return size > 1e-3f ? mean / size : (float3)(LANE(float, x, 0), LANE(float, y, 0), LANE(float, z, 0));
}

Group group_of(const Starts* s) {
    Group group;
    group.middle = (float3)(mean_lane(s->x), mean_lane(s->y), mean_lane(s->z));
    group.normal = common_direction(s->normal_x, s->normal_y, s->normal_z);
    group.axis = common_direction(s->axis_x, s->axis_y, s->axis_z);
    Floats x = group.middle.x - s->x, y = group.middle.y - s->y, z = group.middle.z - s->z;
    group.radius = most_length(x, y, z);
    group.lifted = most_lane(x * group.normal.x + y * group.normal.y + z * group.normal.z);
    group.turned =
        most_length(s->normal_x - group.normal.x, s->normal_y - group.normal.y, s->normal_z - group.normal.z);
    group.twisted = most_length(s->axis_x - group.axis.x, s->axis_y - group.axis.y, s->axis_z - group.axis.z);
    group.least_scale = least_lane(s->scale);
    group.most_scale = most_lane(s->scale);
    return group;
}

// A child of a node as it appears from the lanes' starts.
typedef struct {
    Floats x, y, z;  // its middle, from the start of the rays
    Floats plane;    // its plane: n . p = plane; zero: it is not seen
    Numbers side;    // which of its sides is seen
    int4 pixels;     // first and last column, first and last row that any lane may see it at
} Child;

// Returns the least of each of four vectors' lanes.
float4 least_lanes(Floats a, Floats b, Floats c, Floats d) {
#if LANES == 8
    float4 e = LEAST(a.lo, a.hi), f = LEAST(b.lo, b.hi), g = LEAST(c.lo, c.hi), h = LEAST(d.lo, d.hi);
    float4 ef = LEAST((float4)(e.lo, f.lo), (float4)(e.hi, f.hi));
    float4 gh = LEAST((float4)(g.lo, h.lo), (float4)(g.hi, h.hi));
    return LEAST((float4)(ef.even, gh.even), (float4)(ef.odd, gh.odd));
#else
    return (float4)(a, b, c, d);
#endif
}

// Lets a pixel show a child in those lanes whose ray meets it at the distance t.
void show(Pixel* pixel, const Child* child, Floats t, Flags met) {
    met &= (t < pixel->depth) | (child->side < pixel->side);  // the smaller of two at one distance, on every run
    pixel->depth = select(pixel->depth, t, met);
    pixel->side = select(pixel->side, child->side, met);
}

void draw_surfel(global const WideNode* node, int k, const Child* child, Pixel* pixels) {
    float nx = node->nx[k], ny = node->ny[k], nz = node->nz[k], radius2 = node->bound[k] * node->bound[k];
    Floats cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            Floats t = plane / (p->x * nx + p->y * ny + p->z * nz);
            Floats x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            Flags met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2);
            if (ANY_LANE(met)) show(p, child, t, met);
        }
}

// A node of several directions: a disc that faces each start, drawn by chance.
void draw_cloud(global const WideNode* node, int k, const Child* child, Numbers seeds, Pixel* pixels) {
    float radius2 = node->bound[k] * node->bound[k], fill = node->low_x[k];
    Floats nearer = rsqrt(child->x * child->x + child->y * child->y + child->z * child->z);
    Floats nx = child->x * nearer, ny = child->y * nearer, nz = child->z * nearer;
    Floats cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            Floats t = plane / (p->x * nx + p->y * ny + p->z * nz);
            Floats x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            Flags met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2);
            if (!ANY_LANE(met)) continue;
            met &= fractions_of((child->side >> 1) * 0x9e3779b9u + seeds + (uint)(j * GRID + i)) < fill;
            show(p, child, t, met);
        }
}

// A node of one surface: what of its plane is in its sphere, in its box, and in parts of the box that its mask has.
void draw_surface(global const WideNode* node, int k, const Child* child, Pixel* pixels) {
    float nx = node->nx[k], ny = node->ny[k], nz = node->nz[k], radius2 = node->bound[k] * node->bound[k];
    float3 low = (float3)(node->low_x[k], node->low_y[k], node->low_z[k]);
    float3 high = (float3)(node->high_x[k], node->high_y[k], node->high_z[k]);
    uint mask_low = node->mask_low[k], mask_high = node->mask_high[k];
    bool whole = (mask_low & mask_high) == 0xffffffffu;
    float size_x = fabs(nx), size_y = fabs(ny), size_z = fabs(nz);
    bool along_x = size_x >= size_y && size_x >= size_z, along_y = !along_x && size_y >= size_z;
    float3 parts = 8.0f / (high - low);
    Floats cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            Floats t = plane / (p->x * nx + p->y * ny + p->z * nz);
            Floats x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            // Few comparisons: each costs more than arithmetic.
            Floats room = LEAST(LEAST(x - low.x, high.x - x), LEAST(y - low.y, high.y - y));
            room = LEAST(room, LEAST(z - low.z, high.z - z));
            Flags met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2) & (room >= 0.0f);
            if (!ANY_LANE(met)) continue;
            if (!whole) {
                Floats u = along_x ? (y - low.y) * parts.y : along_y ? (z - low.z) * parts.z : (x - low.x) * parts.x;
                Floats v = along_x ? (z - low.z) * parts.z : along_y ? (x - low.x) * parts.x : (y - low.y) * parts.y;
                Numbers bit = TO_NUMBERS(clamp(u, 0.0f, 7.0f)) + 8u * TO_NUMBERS(clamp(v, 0.0f, 7.0f));
                Numbers bits = select((Numbers)(mask_low), (Numbers)(mask_high), bit >= 32u);
                met &= ((bits >> (bit & 31u)) & 1u) != 0u;
            }
            show(p, child, t, met);
        }
}

#if LUCARNE_FILL_PIXELS
// Draws a child as the pixel at its middle, if that pixel has a ray: the paper's buffers without ray casting (fig. 11).
void fill_pixel(const Child* child, Floats columns, Floats rows, Floats distances, Pixel* pixels) {
    for (int lane = 0; lane < LANES; ++lane) {
        int i = convert_int_rte(LANE(float, columns, lane)), j = convert_int_rte(LANE(float, rows, lane));
        if (LANE(float, child->plane, lane) == 0.0f || i < 0 || i >= GRID || j < 0 || j >= GRID) continue;
        Pixel* p = pixels + j * GRID + i;
        float distance = LANE(float, distances, lane), depth = LANE(float, p->depth, lane);
        uint side = LANE(uint, child->side, lane);
        bool nearest = distance < depth || (distance == depth && side < LANE(uint, p->side, lane));
        bool cast = LANE(float, p->x, lane) != 0.0f || LANE(float, p->y, lane) != 0.0f || LANE(float, p->z, lane) != 0.0f;
        if (!cast || !nearest) continue;
        LANE(float, p->depth, lane) = distance;
        LANE(uint, p->side, lane) = side;
    }
}
#endif

// Draws a child of a node into the pictures of those lanes above whose planes it rises.
void draw_child(global const WideNode* node, int k, uint slot, const Starts* s, Pixel* pixels) {
    float bound = node->bound[k], nx = node->nx[k], ny = node->ny[k], nz = node->nz[k];
    bool cloud = node->high_x[k] == kCloud;
    Child child;
    child.x = node->x[k] - s->x;
    child.y = node->y[k] - s->y;
    child.z = node->z[k] - s->z;
    Floats distance2 = MOST(child.x * child.x + child.y * child.y + child.z * child.z, (Floats)(1e-30f));
    Floats height = child.x * s->normal_x + child.y * s->normal_y + child.z * s->normal_z;
    Floats facing = nx * s->normal_x + ny * s->normal_y + nz * s->normal_z;
    // What the discs of the child rise above its middle: those of the point's own surface lie below the start.
    Floats rise = bound * SLACK * quick_sqrt(1.0f - facing * facing) + node->thickness[k];
    Floats along = child.x * s->axis_x + child.y * s->axis_y + child.z * s->axis_z;
    Flags seen = (height > -LEAST(rise, (Floats)(bound))) & (along > -bound);
    if (!ANY_LANE(seen)) return;
    child.plane = child.x * nx + child.y * ny + child.z * nz;
    child.side = (Numbers)(2u * slot) + select((Numbers)(0u), (Numbers)(1u), child.plane >= 0.0f);
    Floats nearer = quick_rsqrt(distance2);
    // The picture of the cone about a sphere: its directions are c u + s v with unit vectors v across u.
    Floats sine = LEAST(bound * SLACK * nearer, (Floats)(1.0f)), c = quick_sqrt(1.0f - sine * sine) * s->pixels;
    Floats ux = (child.x * s->side_x + child.y * s->side_y + child.z * s->side_z) * nearer;
    Floats uy = (child.x * s->across_x + child.y * s->across_y + child.z * s->across_z) * nearer;
    Floats px = ux * c + (0.5f * GRID - 0.5f), py = uy * c + (0.5f * GRID - 0.5f);
    // Along the axis a it reaches to s times the length of a' = a - (a . u) u. Of that the piece of a plane with the normal
    // n takes the length of a' - (a' . n) n, but for what is of the second order of s.
    Floats wide = 1.0f - ux * ux, tall = 1.0f - uy * uy;
    if (!cloud) {
        Floats dn = child.plane * nearer, none = (Floats)(0.0f);
        Floats an = nx * s->side_x + ny * s->side_y + nz * s->side_z - ux * dn;
        Floats bn = nx * s->across_x + ny * s->across_y + nz * s->across_z - uy * dn;
        wide = LEAST(1.0f - 0.5f * ux * ux, SLACK * quick_sqrt(wide - an * an) + 2.0f * sine);
        tall = LEAST(1.0f - 0.5f * uy * uy, SLACK * quick_sqrt(tall - bn * bn) + 2.0f * sine);
    } else {
        child.plane = sqrt(distance2);
        wide = SLACK * quick_sqrt(wide);
        tall = SLACK * quick_sqrt(tall);
    }
    child.plane = select((Floats)(0.0f), child.plane, seen);
#if LUCARNE_FILL_PIXELS
    fill_pixel(&child, px, py, sqrt(distance2), pixels);
    return;
#endif
    wide = wide * sine * s->pixels + 0.55f;
    tall = tall * sine * s->pixels + 0.55f;
    // Cones about the end of an axis reach to its end.
    wide = select(wide, (Floats)(2.0f * GRID), (sine >= 1.0f) | (ux * ux + sine * sine > 1.0f));
    tall = select(tall, (Floats)(2.0f * GRID), (sine >= 1.0f) | (uy * uy + sine * sine > 1.0f));
    Floats none = (Floats)(2.0f * GRID);
    float4 ends = ceil(least_lanes(select(none, px - wide, seen), select(none, -px - wide, seen),
                                   select(none, py - tall, seen), select(none, -py - tall, seen)));
    child.pixels = convert_int4(fmax(fmin(ends * (float4)(1, -1, 1, -1), (float4)(GRID, GRID - 1, GRID, GRID - 1)),
                                     (float4)(0, -1, 0, -1)));
    if (cloud && node->child[k] >= 0)
        draw_cloud(node, k, &child, s->seed, pixels);
    else if (node->child[k] < 0)
        draw_surfel(node, k, &child, pixels);
    else
        draw_surface(node, k, &child, pixels);
}

// Draws everything above the lanes' planes into their pictures: for each pixel the distance of the nearest disc and its
// side. Which nodes are opened and which are left out is decided for all lanes together.
void draw(global const WideNode* nodes, const Starts* starts, Pixel* pixels) {
    Group group = group_of(starts);
    int stack[STACK];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        int at = stack[--top];
        global const WideNode* node = nodes + at;
        float8 dx = vload8(0, node->x) - group.middle.x, dy = vload8(0, node->y) - group.middle.y;
        float8 dz = vload8(0, node->z) - group.middle.z;
        float8 bound = vload8(0, node->bound), thickness = vload8(0, node->thickness);
        float8 nx = vload8(0, node->nx), ny = vload8(0, node->ny), nz = vload8(0, node->nz);
        int8 child = vload8(0, node->child);
        float8 height = dx * group.normal.x + dy * group.normal.y + dz * group.normal.z;
        float8 facing = nx * group.normal.x + ny * group.normal.y + nz * group.normal.z;
        float8 distance2 = dx * dx + dy * dy + dz * dz, distance = sqrt(distance2), far = distance + group.radius;
        float8 rise = bound * (sqrt(fmax(1.0f - facing * facing, 0.0f)) + group.turned) + thickness;
        rise = LEAST(rise, bound) + group.lifted + far * group.turned;
        int8 above = (height > -rise) & (child != (int8)(kNoChild));
        float8 along = dx * group.axis.x + dy * group.axis.y + dz * group.axis.z, off = group.radius + far * group.twisted;
        above &= along > -bound - off;
        // Spheres beside the cones that the pictures show: sin(a + b) <= sin a + sin b.
        if (group.most_scale < 1.0f) {
            float8 reach = far * group.most_scale + bound + off;
            above &= distance2 - along * along <= reach * reach;
        }
        float8 near = fmax(distance - group.radius, 0.0f) * group.least_scale;
        int8 thick = (vload8(0, node->high_x) == (float8)(kCloud)) | (thickness > near * THICKEST);
        float8 limit = select((float8)(LARGEST), (float8)(LARGEST_THICK), thick);
        int8 large = (bound > near * limit) & (child >= 0);
        top = push(above & large, child, stack, top);
        int8 drawn = above & ~large;
#if LANES == 8  // a processor: loads the next node while children of this one are drawn (nave: a tenth of the time)
        if (top > 0) {
            const char* ahead = (const char*)(ulong)(nodes + stack[top - 1]);
            for (int line = 0; line < 9; ++line) __builtin_prefetch(ahead + 64 * line);
        }
#endif
        if (!any_of(drawn)) continue;
        int draws[8];
        vstore8(drawn, 0, draws);
        for (int k = 0; k < 8; ++k)
            if (draws[k]) draw_child(node, k, (uint)(at * 8 + k), starts, pixels);
    }
}
