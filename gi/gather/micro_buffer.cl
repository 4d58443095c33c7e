// Draws the tree of surfels into micro-buffers, small pictures of the half spaces above points (gather.cl): those of eight
// points that lie close together at once, each in a lane of the vectors (draw_eight.cl), or that of one point, eight
// pixels at a time (draw_one.cl).
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
typedef uint8 Numbers;
#define TO_FLOATS convert_float8
#else
typedef float Floats;
typedef uint Numbers;
#define TO_FLOATS convert_float
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
float8 quick_rsqrt(float8 x) {
    float8 guess = as_float8(0x5f375a86 - (as_int8(x) >> 1));
    return guess * (1.5f - 0.5f * x * guess * guess);
}
// Of what is under zero: zero.
float8 quick_sqrt(float8 x) {
    float8 least = MOST(x, (float8)(1e-12f));
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
        met &= ox * vload8(0, node->low_x) + oy * vload8(0, node->low_y) + oz * vload8(0, node->low_z) <= 1.0f;
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

// The micro-buffers of all lanes, GRID rows of GRID pixels: direction of a pixel's ray, zero where there is none; depth of
// the nearest that was drawn, NOTHING if there is none; side, twice the slot that was drawn, and one more for its back,
// or EMPTY. ROWS and COLUMNS are those that are set.
#if LANES == 8
typedef struct {
    float8 x, y, z, depth;
    uint8 side;
} Pixel;
typedef struct {
    Pixel pixels[PIXELS];
} Picture;
#define ROWS GRID
#define COLUMNS GRID
#define PIXEL(type, picture, what, pixel, lane) LANE(type, (picture)->pixels[pixel].what, lane)
#else
#define ROWS (GRID + 1)                // with a row of room below the last, for what is drawn two rows at a time
#define COLUMNS ((GRID + 14) / 8 * 8)  // with room for vectors of eight behind the last pixel
typedef struct {
    float x[ROWS * COLUMNS], y[ROWS * COLUMNS], z[ROWS * COLUMNS], depth[ROWS * COLUMNS];
    uint side[ROWS * COLUMNS];
} Picture;
#define PIXEL(type, picture, what, pixel, lane) (picture)->what[(pixel) / GRID * COLUMNS + (pixel) % GRID]
#endif

float3 direction_of(const Picture* picture, int pixel, int lane) {
    return (float3)(PIXEL(float, picture, x, pixel, lane), PIXEL(float, picture, y, pixel, lane),
                    PIXEL(float, picture, z, pixel, lane));
}

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

// What a child of a node may cover of a picture: its middle, and how far it reaches from there, in pixels.
typedef struct {
    float8 x, y, wide, tall;
} Outline;

// Bounds of a child of a node, from its middle and its normal along the axes of the picture, 1 over its distance, and that
// of its plane. A picture has `size` pixels for 1 along its axes.
Outline outline_of(float8 side, float8 across, float8 nearer, float8 bound, float8 facing_side, float8 facing_across,
                   float8 plane, int8 cloud, float8 size) {
    // The picture of the cone about a sphere: its directions are c u + s v with unit vectors v across u.
    float8 s = LEAST(bound * SLACK * nearer, (float8)(1.0f)), c = quick_sqrt(1.0f - s * s) * size;
    float8 ux = side * nearer, uy = across * nearer;
    // Along the axis a it reaches to s times the length of a' = a - (a . u) u. Of that the piece of a plane with the normal
    // n takes the length of a' - (a' . n) n, but for what is of the second order of s.
    float8 away = plane * nearer, an = facing_side - ux * away, bn = facing_across - uy * away;
    float8 wide = 1.0f - ux * ux, tall = 1.0f - uy * uy;
    float8 wide_piece = LEAST(1.0f - 0.5f * ux * ux, SLACK * quick_sqrt(wide - an * an) + 2.0f * s);
    float8 tall_piece = LEAST(1.0f - 0.5f * uy * uy, SLACK * quick_sqrt(tall - bn * bn) + 2.0f * s);
    Outline o;
    o.x = ux * c + (0.5f * GRID - 0.5f);
    o.y = uy * c + (0.5f * GRID - 0.5f);
    o.wide = select(wide_piece, SLACK * quick_sqrt(wide), cloud) * s * size + 0.55f;
    o.tall = select(tall_piece, SLACK * quick_sqrt(tall), cloud) * s * size + 0.55f;
    // Cones about the end of an axis reach to its end.
    o.wide = select(o.wide, (float8)(2.0f * GRID), (s >= 1.0f) | (ux * ux + s * s > 1.0f));
    o.tall = select(o.tall, (float8)(2.0f * GRID), (s >= 1.0f) | (uy * uy + s * s > 1.0f));
    return o;
}

#if LUCARNE_FILL_PIXELS
// Draws a child as the pixel at its middle, if that pixel has a ray: the paper's buffers without ray casting (fig. 11).
// `k`: its place in the outlines.
void fill_pixel(const Outline* outlines, int k, float distance, uint side, Picture* picture, int lane) {
    int i = convert_int_rte(LANE(float, outlines->x, k)), j = convert_int_rte(LANE(float, outlines->y, k));
    if (i < 0 || i >= GRID || j < 0 || j >= GRID) return;
    int pixel = j * GRID + i;
    float3 ray = direction_of(picture, pixel, lane);
    float depth = PIXEL(float, picture, depth, pixel, lane);
    bool nearest = distance < depth || (distance == depth && side < PIXEL(uint, picture, side, pixel, lane));
    if (dot(ray, ray) == 0.0f || !nearest) return;
    PIXEL(float, picture, depth, pixel, lane) = distance;
    PIXEL(uint, picture, side, pixel, lane) = side;
}
#endif

#if LANES == 8
#include "gi/gather/draw_eight.cl"
#else
#include "gi/gather/draw_one.cl"
#endif

// Draws everything above the lanes' planes into their pictures: for each pixel the distance of the nearest disc and its
// side. Which nodes are opened and which are left out is decided for all lanes together.
void draw(global const WideNode* nodes, const Starts* starts, Picture* picture) {
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
        draw_children(node, (uint)at * 8, drawn, starts, picture);
    }
}
