// Draws nodes into the micro-buffers of eight points at once, each in a lane of the vectors (micro_buffer.cl): a child
// meets one pixel's rays of all of them at a time.

// Sets the rays of a pixel that shows nothing yet.
void set_rays(Picture* picture, int column, int row, float8 x, float8 y, float8 z) {
    Pixel* pixel = picture->pixels + row * GRID + column;
    pixel->x = x;
    pixel->y = y;
    pixel->z = z;
    pixel->depth = (float8)(NOTHING);
    pixel->side = (uint8)(EMPTY);
}

// A child of a node as it appears from the lanes' starts.
typedef struct {
    float8 x, y, z;  // its middle, from the start of the rays
    float8 plane;    // its plane: n . p = plane; zero: it is not seen
    uint8 side;      // which of its sides is seen
    int4 pixels;     // first and last column, first and last row that any lane may see it at
} Child;

// Returns the least of each of four vectors' lanes.
float4 least_lanes(float8 a, float8 b, float8 c, float8 d) {
    float4 e = LEAST(a.lo, a.hi), f = LEAST(b.lo, b.hi), g = LEAST(c.lo, c.hi), h = LEAST(d.lo, d.hi);
    float4 ef = LEAST((float4)(e.lo, f.lo), (float4)(e.hi, f.hi));
    float4 gh = LEAST((float4)(g.lo, h.lo), (float4)(g.hi, h.hi));
    return LEAST((float4)(ef.even, gh.even), (float4)(ef.odd, gh.odd));
}

// Lets a pixel show a child in those lanes whose ray meets it at the distance t.
void show(Pixel* pixel, const Child* child, float8 t, int8 met) {
    met &= (t < pixel->depth) | (child->side < pixel->side);  // the smaller of two at one distance, on every run
    pixel->depth = select(pixel->depth, t, met);
    pixel->side = select(pixel->side, child->side, met);
}

void draw_surfel(global const WideNode* node, int k, const Child* child, Pixel* pixels) {
    float nx = node->nx[k], ny = node->ny[k], nz = node->nz[k], radius2 = node->bound[k] * node->bound[k];
    float edge_x = node->low_x[k], edge_y = node->low_y[k], edge_z = node->low_z[k];
    float8 cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            float8 t = plane / (p->x * nx + p->y * ny + p->z * nz);
            float8 x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            int8 met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2);
            if (!any_of(met)) continue;
            met &= x * edge_x + y * edge_y + z * edge_z <= 1.0f;
            if (any_of(met)) show(p, child, t, met);
        }
}

// A node of several directions: a disc that faces each start, drawn by chance.
void draw_cloud(global const WideNode* node, int k, const Child* child, uint8 seeds, Pixel* pixels) {
    float radius2 = node->bound[k] * node->bound[k], fill = node->low_x[k];
    float8 nearer = rsqrt(child->x * child->x + child->y * child->y + child->z * child->z);
    float8 nx = child->x * nearer, ny = child->y * nearer, nz = child->z * nearer;
    float8 cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            float8 t = plane / (p->x * nx + p->y * ny + p->z * nz);
            float8 x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            int8 met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2);
            if (!any_of(met)) continue;
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
    float8 cx = child->x, cy = child->y, cz = child->z, plane = child->plane;
    int4 part = child->pixels;
    for (int j = part.s2; j <= part.s3; ++j)
        for (int i = part.s0; i <= part.s1; ++i) {
            Pixel* p = pixels + j * GRID + i;
            float8 t = plane / (p->x * nx + p->y * ny + p->z * nz);
            float8 x = p->x * t - cx, y = p->y * t - cy, z = p->z * t - cz;
            // Few comparisons: each costs more than arithmetic.
            float8 room = LEAST(LEAST(x - low.x, high.x - x), LEAST(y - low.y, high.y - y));
            room = LEAST(room, LEAST(z - low.z, high.z - z));
            int8 met = (t > 0.0f) & (t <= p->depth) & (x * x + y * y + z * z <= radius2) & (room >= 0.0f);
            if (!any_of(met)) continue;
            if (!whole) {
                float8 u = along_x ? (y - low.y) * parts.y : along_y ? (z - low.z) * parts.z : (x - low.x) * parts.x;
                float8 v = along_x ? (z - low.z) * parts.z : along_y ? (x - low.x) * parts.x : (y - low.y) * parts.y;
                uint8 bit = convert_uint8(clamp(u, 0.0f, 7.0f)) + 8u * convert_uint8(clamp(v, 0.0f, 7.0f));
                uint8 bits = select((uint8)(mask_low), (uint8)(mask_high), bit >= 32u);
                met &= ((bits >> (bit & 31u)) & 1u) != 0u;
            }
            show(p, child, t, met);
        }
}

// Draws a child of a node into the pictures of those lanes above whose planes it rises.
void draw_child(global const WideNode* node, int k, uint slot, const Starts* s, Picture* picture) {
    float bound = node->bound[k], nx = node->nx[k], ny = node->ny[k], nz = node->nz[k];
    bool cloud = node->high_x[k] == kCloud;
    Child child;
    child.x = node->x[k] - s->x;
    child.y = node->y[k] - s->y;
    child.z = node->z[k] - s->z;
    float8 distance2 = MOST(child.x * child.x + child.y * child.y + child.z * child.z, (float8)(1e-30f));
    float8 height = child.x * s->normal_x + child.y * s->normal_y + child.z * s->normal_z;
    float8 facing = nx * s->normal_x + ny * s->normal_y + nz * s->normal_z;
    // What the discs of the child rise above its middle: those of the point's own surface lie below the start.
    float8 rise = bound * SLACK * quick_sqrt(1.0f - facing * facing) + node->thickness[k];
    float8 along = child.x * s->axis_x + child.y * s->axis_y + child.z * s->axis_z;
    int8 seen = (height > -LEAST(rise, (float8)(bound))) & (along > -bound);
    if (!any_of(seen)) return;
    child.plane = child.x * nx + child.y * ny + child.z * nz;
    child.side = (uint8)(2u * slot) + select((uint8)(0u), (uint8)(1u), child.plane >= 0.0f);
    Outline o = outline_of(child.x * s->side_x + child.y * s->side_y + child.z * s->side_z,
                           child.x * s->across_x + child.y * s->across_y + child.z * s->across_z,
                           quick_rsqrt(distance2), (float8)(bound), nx * s->side_x + ny * s->side_y + nz * s->side_z,
                           nx * s->across_x + ny * s->across_y + nz * s->across_z, child.plane,
                           (int8)(cloud ? -1 : 0), s->pixels);
    if (cloud) child.plane = sqrt(distance2);
    child.plane = select((float8)(0.0f), child.plane, seen);
#if LUCARNE_FILL_PIXELS
    float8 distance = sqrt(distance2);
    for (int lane = 0; lane < 8; ++lane)
        if (LANE(int, seen, lane))
            fill_pixel(&o, lane, LANE(float, distance, lane), LANE(uint, child.side, lane), picture, lane);
    return;
#endif
    float8 none = (float8)(2.0f * GRID);
    float4 ends = ceil(least_lanes(select(none, o.x - o.wide, seen), select(none, -o.x - o.wide, seen),
                                   select(none, o.y - o.tall, seen), select(none, -o.y - o.tall, seen)));
    child.pixels = convert_int4(fmax(fmin(ends * (float4)(1, -1, 1, -1), (float4)(GRID, GRID - 1, GRID, GRID - 1)),
                                     (float4)(0, -1, 0, -1)));
    if (cloud && node->child[k] >= 0)
        draw_cloud(node, k, &child, s->seed, picture->pixels);
    else if (node->child[k] < 0)
        draw_surfel(node, k, &child, picture->pixels);
    else
        draw_surface(node, k, &child, picture->pixels);
}

// Draws those of a node's children that are marked.
void draw_children(global const WideNode* node, uint first_slot, int8 drawn, const Starts* starts, Picture* picture) {
    int draws[8];
    vstore8(drawn, 0, draws);
    for (int k = 0; k < 8; ++k)
        if (draws[k]) draw_child(node, k, first_slot + (uint)k, starts, picture);
}
