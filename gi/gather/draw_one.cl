// Draws nodes into the micro-buffer of one point (micro_buffer.cl): eight children are placed at once, and each meets
// eight rays at a time.
#define FEW_COLUMNS 4  // what they hold is drawn two rows at a time

// Sets the rays of eight pixels that show nothing yet.
void set_rays(Picture* picture, int column, int row, float8 x, float8 y, float8 z) {
    int at = row * COLUMNS + column;
    vstore8(x, 0, picture->x + at);
    vstore8(y, 0, picture->y + at);
    vstore8(z, 0, picture->z + at);
    vstore8((float8)(NOTHING), 0, picture->depth + at);
    vstore8((uint8)(EMPTY), 0, picture->side + at);
}

// Eight children of a node as they appear from the start of the rays.
typedef struct {
    float8 dx, dy, dz;               // middles
    float8 nx, ny, nz, plane;        // their planes: n . p = plane
    uint8 side;                      // which of their sides are seen
    int8 left, right, upper, lower;  // the pixels that they may cover
} Children;

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

// Lets a pixel show a child that its ray meets at the distance t, at a place relative to the child's middle, if the
// child hides that place and nothing nearer.
void show(global const WideNode* node, int k, uint side, int pixel, float t, float x, float y, float z, uint seed,
          Picture* picture) {
    if (t > picture->depth[pixel] || (t == picture->depth[pixel] && picture->side[pixel] < side)) return;
    if (node->high_x[k] == kCloud) {
        if (fractions_of((side >> 1) * 0x9e3779b9u + seed + (uint)pixel) >= node->low_x[k]) return;
    } else if (!hides(node, k, x, y, z)) {
        return;
    }
    picture->depth[pixel] = t;
    picture->side[pixel] = side;
}

// Draws one of eight children: eight pixels at a time, of two rows if four columns hold it. Rays beyond the pixels that
// it may cover pass beside it.
void draw_child(global const WideNode* node, const Children* children, int k, uint seed, Picture* picture) {
    uint side = ((const uint*)&children->side)[k];
    float x = ((const float*)&children->dx)[k], y = ((const float*)&children->dy)[k];
    float z = ((const float*)&children->dz)[k], plane = ((const float*)&children->plane)[k];
    float nx = ((const float*)&children->nx)[k], ny = ((const float*)&children->ny)[k];
    float nz = ((const float*)&children->nz)[k];
    int left = ((const int*)&children->left)[k], right = ((const int*)&children->right)[k];
    int upper = ((const int*)&children->upper)[k], lower = ((const int*)&children->lower)[k];
    float radius2 = node->bound[k] * node->bound[k];
    float3 low = (float3)(node->low_x[k], node->low_y[k], node->low_z[k]);
    float3 high = (float3)(node->high_x[k], node->high_y[k], node->high_z[k]);
    float3 edge = node->child[k] < 0 ? low : (float3)(0.0f);  // where a surfel ends
    if (high.x == kCloud || node->child[k] < 0) low = (float3)(-NOTHING), high = (float3)(NOTHING);
    bool narrow = right - left < FEW_COLUMNS;
    int other = narrow ? COLUMNS : 4;  // where the second four of the eight pixels are, from the first four
    for (int j = upper; j <= lower; j += narrow ? 2 : 1)
        for (int i = left; i <= right; i += narrow ? FEW_COLUMNS : 8) {
            int pixel = j * COLUMNS + i;
            const float *at_x = picture->x + pixel, *at_y = picture->y + pixel, *at_z = picture->z + pixel;
            const float* depth = picture->depth + pixel;
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
            met &= ox * edge.x + oy * edge.y + oz * edge.z <= 1.0f;
            for (int lane = 0; lane < 8; ++lane)
                if (((int*)&met)[lane])
                    show(node, k, side, pixel + (lane & 3) + (lane >> 2) * other, ((float*)&t)[lane],
                         ((float*)&ox)[lane], ((float*)&oy)[lane], ((float*)&oz)[lane], seed, picture);
        }
}

// Draws those of a node's children that are marked.
void draw_children(global const WideNode* node, uint first_slot, int8 drawn, const Starts* s, Picture* picture) {
    Children children;
    float8 dx = vload8(0, node->x) - s->x, dy = vload8(0, node->y) - s->y, dz = vload8(0, node->z) - s->z;
    float8 nx = vload8(0, node->nx), ny = vload8(0, node->ny), nz = vload8(0, node->nz), bound = vload8(0, node->bound);
    float8 distance2 = MOST(dx * dx + dy * dy + dz * dz, (float8)(1e-30f)), nearer = rsqrt(distance2);
    float8 plane = dx * nx + dy * ny + dz * nz, distance = distance2 * nearer;
    int8 cloud = vload8(0, node->high_x) == (float8)(kCloud);
    Outline o = outline_of(dx * s->side_x + dy * s->side_y + dz * s->side_z,
                           dx * s->across_x + dy * s->across_y + dz * s->across_z, nearer, bound,
                           nx * s->side_x + ny * s->side_y + nz * s->side_z,
                           nx * s->across_x + ny * s->across_y + nz * s->across_z, plane, cloud, (float8)(s->pixels));
    children.side = 2u * (first_slot + (uint8)(0, 1, 2, 3, 4, 5, 6, 7)) + select((uint8)(0u), (uint8)(1u), plane >= 0.0f);
#if LUCARNE_FILL_PIXELS
    for (int k = 0; k < 8; ++k)
        if (LANE(int, drawn, k)) fill_pixel(&o, k, LANE(float, distance, k), LANE(uint, children.side, k), picture, 0);
    return;
#endif
    children.dx = dx;
    children.dy = dy;
    children.dz = dz;
    children.nx = select(nx, dx * nearer, cloud);
    children.ny = select(ny, dy * nearer, cloud);
    children.nz = select(nz, dz * nearer, cloud);
    children.plane = select(plane, distance, cloud);
    children.left = convert_int8(fmax(ceil(o.x - o.wide), 0.0f));
    children.right = convert_int8(fmin(floor(o.x + o.wide), GRID - 1.0f));
    children.upper = convert_int8(fmax(ceil(o.y - o.tall), 0.0f));
    children.lower = convert_int8(fmin(floor(o.y + o.tall), GRID - 1.0f));
    drawn &= (children.right >= children.left) & (children.lower >= children.upper);
    int draws[8];
    vstore8(drawn, 0, draws);
    for (int k = 0; k < 8; ++k)
        if (draws[k]) draw_child(node, &children, k, s->seed, picture);
}
