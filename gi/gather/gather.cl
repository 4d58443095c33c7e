// Gathers light at points: draws the tree of surfels into a small picture of the half space above each point, one
// work-item for LUCARNE_LANES points. Ritschel et al. 2009, "Micro-rendering for scalable, parallel final gathering",
// section 2.2.
//
// A pixel is a ray, and a disc covers it if the ray meets the disc. The picture is the unit disc on which directions
// are projected along the normal (Nusselt), so that equal areas of it are equal shares of the irradiance: a square of
// LUCARNE_GRID pixels a side about it.
#include "gi/gather/gather_point.h"
#include "gi/gather/micro_buffer.cl"
#include "gi/shared/direction_cells.h"
#include "gi/shared/lobe.h"
#include "gi/gather/sky_picture.h"

// Narrow lobes are as wide as so many rays of a buffer. Between walls of exponent 1000 (Cornell box, one bounce, 24 x 24
// rays), pictures of two seeds differ by a relMSE of .68 without, .11 with 4, .05 with 8 and .02 with 16; the mean of 8
// frames differs from that of 150 without by .016, .019 and .025, and by .2 to .3 % in energy.
#define kRaysALobe 8.0f
// What is farther than so many lifts for each pixel of a side of a picture that shows a half space appears less than a
// quarter of a pixel from where the surface would see it.
#define NEAR 2.0f
// Backs that are so much brighter than their fronts, and than what is typical, are traced.
#define BRIGHT 4.0f

// Returns the slot whose light the surface receives from a direction. Rays start above the surface to clear its noise,
// and so would see everything from too near. Therefore the light is that of the point where the line from the surface
// itself meets the plane of the disc; the pixel that shows that point knows its slot. `lifted`: from the surface to
// the start, along the axes of the picture.
uint seen_slot(global const WideNode* nodes, const Picture* picture, int lane, uint slot, float depth, float3 ray,
               float3 direction, float3 lifted, float3 position, float lift, float scale) {
    float3 axis = slot_axis(nodes, slot);
    float straight = dot(axis, slot_middle(nodes, slot) - position) / dot(axis, direction);
    if (!(straight > 0.0f) || fabs(straight - depth) > MOST_SHIFT * lift) return slot;
    float3 seen = ray * straight - lifted;
    if (!(seen.z > 0.0f)) return slot;
    float pixels = rsqrt(dot(seen, seen)) * (0.5f * GRID / scale);
    int i = clamp((int)(seen.x * pixels + 0.5f * GRID), 0, GRID - 1);
    int j = clamp((int)(seen.y * pixels + 0.5f * GRID), 0, GRID - 1);
    uint other = PIXEL(uint, picture, side, j * GRID + i, lane);
    if (other == EMPTY || other / 2 == slot) return slot;
    other /= 2;
    // It has to be the same surface, not what stands beside it.
    float3 point = position + direction * straight;
    float away = fabs(dot(slot_axis(nodes, other), point - slot_middle(nodes, other)));
    float allowed = 2.0f * lift + nodes[other / 8].thickness[other % 8];
    return away <= allowed ? other : slot;
}

// Returns whether a place sees the back of a slot: it sees the side of the plane on which it is.
bool shows_back(global const WideNode* nodes, uint slot, float3 place) {
    return dot(slot_axis(nodes, slot), slot_middle(nodes, slot) - place) >= 0.0f;
}

// Whether the back of a slot sends much more light than its front and than is `typical`, or nothing is known about it.
bool back_is_bright(global const float* light, uint slot, float typical) {
    if (!light) return true;
    float3 front = vload3(2 * slot, light), back = vload3(2 * slot + 1, light);
    return back.x + back.y + back.z > BRIGHT * fmax(front.x + front.y + front.z, 3.0f * typical);
}

// A micro-buffer's place: its start, the axes of its picture, and its set of rays, x and y of all pixels in the unit
// disc; x is over 1 where a pixel has no ray.
typedef struct {
    float3 position, normal, start, side, across, axis;
    float scale;
    bool shown;  // by a picture
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
    place.shown = point.viewer.x != 0.0f || point.viewer.y != 0.0f || point.viewer.z != 0.0f;
    float3 axis = place.axis;
    Floats turn = fractions_of((Numbers)(point.seed / sets));  // what is drawn together has the same
    float angle = 6.28318531f * LANE(float, turn, 0);
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

// Points that are drawn at once.
typedef struct {
    uint first;        // number of the first lane's point
    int lanes;         // that have a point of their own
    uint cast[LANES];  // rays of the buffer
    GatherPoint points[LANES];
    Place places[LANES];
    Picture picture;
} Pictures;

// Draws what is above the points of a group. `first`: the number of the first point of each group, and the end.
void draw_pictures(global const WideNode* nodes, global const GatherPoint* points, global const float* rays, uint sets,
                   global const uint* first, uint group, Pictures* pictures) {
    Starts s;
    pictures->first = first[group];
    pictures->lanes = first[group + 1] - first[group];
    for (int lane = 0; lane < LANES; ++lane) {
        pictures->points[lane] = points[pictures->first + (lane < pictures->lanes ? lane : 0)];
        pictures->places[lane] = place_of(nodes, pictures->points[lane], rays, sets);
        pictures->cast[lane] = 0;
        const Place* place = &pictures->places[lane];
        LANE(float, s.x, lane) = place->start.x;
        LANE(float, s.y, lane) = place->start.y;
        LANE(float, s.z, lane) = place->start.z;
        LANE(float, s.normal_x, lane) = place->normal.x;
        LANE(float, s.normal_y, lane) = place->normal.y;
        LANE(float, s.normal_z, lane) = place->normal.z;
        LANE(float, s.axis_x, lane) = place->axis.x;
        LANE(float, s.axis_y, lane) = place->axis.y;
        LANE(float, s.axis_z, lane) = place->axis.z;
        LANE(float, s.side_x, lane) = place->side.x;
        LANE(float, s.side_y, lane) = place->side.y;
        LANE(float, s.side_z, lane) = place->side.z;
        LANE(float, s.across_x, lane) = place->across.x;
        LANE(float, s.across_y, lane) = place->across.y;
        LANE(float, s.across_z, lane) = place->across.z;
        LANE(float, s.scale, lane) = place->scale;
        LANE(float, s.pixels, lane) = 0.5f * GRID / place->scale;
        LANE(uint, s.seed, lane) = pictures->points[lane].seed;
    }
    // Eight rays at once: one of each lane, or eight of a row.
    for (int j = 0; j < ROWS; ++j)
        for (int i = 0; i < COLUMNS; i += 8 / LANES) {
            float8 x, y;
            for (int k = 0; k < 8; ++k) {
                int column = i + k / LANES, pixel = j * GRID + column;
                bool inside = column < GRID && j < GRID;
                LANE(float, x, k) = inside ? pictures->places[k % LANES].set[pixel] : 2.0f;
                LANE(float, y, k) = inside ? pictures->places[k % LANES].set[PIXELS + pixel] : 2.0f;
                pictures->cast[k % LANES] += LANE(float, x, k) <= 1.0f;
            }
            int8 shown = x <= 1.0f;
            x *= s.scale;
            y *= s.scale;
            float8 z = sqrt(fmax(1.0f - x * x - y * y, (float8)(0.0f)));
            float8 dx = s.side_x * x + s.across_x * y + s.axis_x * z;
            float8 dy = s.side_y * x + s.across_y * y + s.axis_y * z;
            float8 dz = s.side_z * x + s.across_z * y + s.axis_z * z;
            shown &= dx * s.normal_x + dy * s.normal_y + dz * s.normal_z > 0.0f;
            set_rays(&pictures->picture, i, j, select((float8)(0.0f), dx, shown), select((float8)(0.0f), dy, shown),
                     select((float8)(0.0f), dz, shown));
        }
    draw(nodes, &s, &pictures->picture);
}

// Returns the side that a pixel sees, twice the slot and one more for the back, or kSeesSky, if a slot was drawn there.
//
// A node is drawn as a piece of one plane, so at edges it sticks out a little, and those who look past the edge would see
// its back. Scans turn their fronts to the room; backs may be a hundred times as bright, outside in the sun. So where a
// back seems to be seen, the ray is traced surfel by surfel, for points of the picture; for those between which light is
// exchanged it would take three times as long. Where the light of both sides is known, only backs that are much brighter
// are traced: in scans whose normals are often reversed, most rays see backs. `typical`: the mean radiance that points
// receive; where reversed surfels are lit by the lamps of their room, their backs are brighter than their fronts, but not
// than that.
uint seen_side(global const WideNode* nodes, const Pictures* pictures, int lane, int pixel, float3 direction,
               global const float* light, float typical) {
    const Place* place = &pictures->places[lane];
    uint side = PIXEL(uint, &pictures->picture, side, pixel, lane);
    if (side == EMPTY) return kSeesSky;
    float depth = PIXEL(float, &pictures->picture, depth, pixel, lane), lift = pictures->points[lane].lift;
    if (depth < lift * (NEAR * GRID) / place->scale) {
        float3 away = place->start - place->position;
        float3 lifted = (float3)(dot(away, place->side), dot(away, place->across), dot(away, place->axis));
        float3 ray = (float3)(dot(direction, place->side), dot(direction, place->across), dot(direction, place->axis));
        uint slot = seen_slot(nodes, &pictures->picture, lane, side / 2, depth, ray, direction, lifted, place->position,
                              lift, place->scale);
        if (slot != side / 2) side = 2 * slot + (shows_back(nodes, slot, place->start) ? 1u : 0u);
    }
    uint slot = side / 2;
    if ((side & 1) && place->shown && nodes[slot / 8].child[slot % 8] >= 0 && back_is_bright(light, slot, typical)) {
        float about = 2.0f * nodes[slot / 8].bound[slot % 8], most = NOTHING;
        slot = first_surfel(nodes, place->start, direction, fmax(depth - about, 0.0f), &most);
        if (slot == EMPTY) return kSeesSky;
        side = 2 * slot + (shows_back(nodes, slot, place->start) ? 1u : 0u);
    }
    return side;
}

// Returns 1 less the mean cosine between a ray of a buffer and the directions of the cone about it that has the solid
// angle of kRaysALobe rays, which is the cone's share of the sphere.
float spread_of(Place place, float cosine) {
    float rays = 0.78539816f * GRID * GRID;  // in the disc that the grid covers
    return kRaysALobe * place.scale * place.scale / (4.0f * rays * fmax(cosine, 0.1f));
}

// Returns the specular light of a side in a direction, W/(sr m^2). The lobe is wider by `spread` (spread_of): rays meet
// narrow lobes by chance, and few pixels would be as bright as they are with them.
float3 specular(global const float* light, global const float* directions, uint side, float3 to, float spread) {
    float3 sent = vload3(side, light);
    if (!(sent.x + sent.y + sent.z > 0.0f)) return (float3)(0.0f);
    return sent * lobe_radiance(sent, vload3(side, directions) * fmax(1.0f - spread, 0.0f), to);
}

float3 sky_radiance(global const float* texels, SkyPicture sky, float3 direction) {
    vec2 place = environment_place(direction, sky.rotation);
    uint x = min((uint)(place.x * sky.width), sky.width - 1u), y = min((uint)(place.y * sky.height), sky.height - 1u);
    return vload3(y * sky.width + x, texels);
}

// Returns how much a ray that meets nothing counts: rays to spheres at openings (SkyOpenings) may find the same light, and
// each counts by its density (balance heuristic, Veach & Guibas 1995). `openings`: middles and radii; `densities`: of the
// rays to each, over those of the buffer toward its axis.
float share_of_buffer(global const float4* openings, uint count, global const float* densities, float3 position,
                      float3 direction, float cosine) {
    float sum = cosine;
    for (uint i = 0; i < count; ++i) {
        if (!(densities[i] > 0.0f)) continue;
        float4 sphere = openings[i];
        float3 middle = sphere.xyz - position, beside = cross(direction, middle);
        if (dot(direction, middle) > 0.0f && dot(beside, beside) < sphere.w * sphere.w) sum += densities[i];
    }
    return cosine / sum;
}

// Returns what of a side's light buffers see at a distance: VPLs bring the rest (BrightLight). `bright`: of each side
// what is too bright, of which they bring the share of far points.
float3 without_bright(float3 radiance, global const float* bright, float reach2, uint side, float distance) {
    float distance2 = distance * distance;
    return radiance - vload3(side, bright) * (distance2 / (distance2 + reach2));
}

// For each point: the mean radiance of its rays, W/(sr m^2) (times pi: irradiance), and the share of rays that meet
// nothing. `light`: six floats a slot, the radiance of its front and of its back; lit = 0: `nodes` only block.
// `lobe_light` and `lobe_directions`, likewise: what it sends out by specular lobes, if glossy is not 0. `sky` shines
// where there is nothing; without texels it is dark. What is `bright` is left out unless reach2 is negative. `open`:
// spheres at openings, with so many `densities` for each point. `typical`: see seen_side(); 0: unknown.
kernel void gather(global const WideNode* nodes, global const float* light, uint lit, float typical,
                   global const float* lobe_light,
                   global const float* lobe_directions, uint glossy, global const float* bright, float reach2,
                   global const float* sky_texels, SkyPicture sky, global const float4* openings, uint open,
                   global const float* densities, global const GatherPoint* points, global const float* rays,
                   uint sets, global const uint* first, uint groups, global float4* results) {
    if (get_global_id(0) >= groups) return;
    Pictures pictures;
    draw_pictures(nodes, points, rays, sets, first, get_global_id(0), &pictures);
    for (int lane = 0; lane < pictures.lanes; ++lane) {
        uint number = pictures.first + lane;
        const Place* place = &pictures.places[lane];
        float exponent = pictures.points[lane].exponent;
        float3 sum = (float3)(0.0f);
        uint empty = 0;
        for (int pixel = 0; pixel < PIXELS; ++pixel) {
            float3 direction = direction_of(&pictures.picture, pixel, lane);
            float height = dot(direction, place->normal);
            if (!(height > 0.0f)) continue;
            float weight = 1.0f;
            if (exponent > 0.0f) weight = pow(dot(direction, place->axis), exponent - 1.0f) * height;
            uint side = seen_side(nodes, &pictures, lane, pixel, direction, lit ? light : 0, typical);
            if (side == kSeesSky) {
                ++empty;
                if (sky.width == 0) continue;
                if (open > 0)
                    weight *= share_of_buffer(openings, open, densities + number * open, place->position, direction,
                                              height);
                sum += weight * sky_radiance(sky_texels, sky, direction);
            } else if (lit) {
                float3 radiance = vload3(side, light);
                if (reach2 >= 0.0f)
                    radiance = without_bright(radiance, bright, reach2, side,
                                              PIXEL(float, &pictures.picture, depth, pixel, lane));
                sum += weight * radiance;
                if (glossy)
                    sum += weight * specular(lobe_light, lobe_directions, side, -direction,
                                             spread_of(*place, dot(direction, place->axis)));
            }
        }
        uint cast = pictures.cast[lane];
        results[number] = (float4)(sum / cast, (float)(empty) / cast);
    }
}

// Sets what each pixel of the buffers of points sees: a side (seen_side), kSeesSky or kSeesNothing, GRID * GRID for each
// point; and the mean of 1 over the distance, 1/m, which is taken as at least the lift.
kernel void see(global const WideNode* nodes, global const GatherPoint* points, global const float* rays, uint sets,
                global const uint* first, uint begin, uint groups, global uint* seen, global float* nearness) {
    if (get_global_id(0) >= groups) return;
    Pictures pictures;
    draw_pictures(nodes, points, rays, sets, first, begin + get_global_id(0), &pictures);
    for (int lane = 0; lane < pictures.lanes; ++lane) {
        uint number = pictures.first + lane;
        global uint* sees = seen + number * (uint)(PIXELS);
        float lift = pictures.points[lane].lift, near = 0.0f;
        uint cast = 0;
        for (int pixel = 0; pixel < PIXELS; ++pixel) {
            float3 direction = direction_of(&pictures.picture, pixel, lane);
            uint code = kSeesNothing;
            if (dot(direction, pictures.places[lane].normal) > 0.0f) {
                ++cast;
                code = seen_side(nodes, &pictures, lane, pixel, direction, 0, 0.0f);
                if (code != kSeesSky)
                    near += 1.0f / fmax(PIXEL(float, &pictures.picture, depth, pixel, lane), fmax(lift, 1e-6f));
            }
            sees[pixel] = code;
        }
        nearness[number] = cast > 0 ? near / cast : 0.0f;
    }
}

// What lights buffers that are kept. Arguments as of gather(); `densities`: of the point alone.
typedef struct {
    global const WideNode* nodes;
    global const float *surfels, *lobes, *lobe_directions, *bright;
    uint lit, glossy;
    float reach2;
    global const float* sky_texels;
    SkyPicture sky;
    global const float4* openings;
    uint open;
    global const float* densities;
} Light;

// Returns the radiance that arrives along a ray of a kept buffer, without that of specular lobes. `code`: what the ray sees
// (see()).
float3 arriving(const Light* light, const Place* place, uint code, float3 direction) {
    float3 radiance = (float3)(0.0f);
    if (code != kSeesSky) {
        if (light->lit) radiance = vload3(code, light->surfels);
        if (light->lit && light->reach2 >= 0.0f)
            radiance = without_bright(radiance, light->bright, light->reach2, code,
                                      length(slot_middle(light->nodes, code / 2) - place->position));
    } else if (light->sky.width > 0) {
        radiance = sky_radiance(light->sky_texels, light->sky, direction);
        if (light->open > 0)
            radiance *= share_of_buffer(light->openings, light->open, light->densities, place->position, direction,
                                        dot(direction, place->normal));
    }
    return radiance;
}

// Returns that of specular lobes. `height`: of the direction over the surface.
float3 arriving_by_lobes(const Light* light, const Place* place, uint code, float3 direction, float height) {
    if (!light->glossy || code == kSeesSky) return (float3)(0.0f);
    return specular(light->lobes, light->lobe_directions, code, -direction, spread_of(*place, height));
}

// Returns the place of a point whose buffer is kept: the start of its rays does not matter any more.
Place kept_place(global const WideNode* nodes, GatherPoint point, global const float* rays, uint sets) {
    point.viewer.x = point.viewer.y = point.viewer.z = 0.0f;
    return place_of(nodes, point, rays, sets);
}

// For each point: the light that it receives by what its buffer sees, as the ten terms of a LightByNormal (three floats
// each). At the point's own normal it is the mean over the rays, as gather() has it. What changes with the normal is that
// of the spherical harmonics up to the second order (Ramamoorthi & Hanrahan 2001, "An efficient representation for
// irradiance environment maps"): they turn max(c, 0), c the cosine between normal and ray, into 3/32 + c/2 + 15/32 c^2.
// Arguments as above; `first`: the number of the first of `count` points.
kernel void shade(global const WideNode* nodes, global const float* light, uint lit, global const float* lobe_light,
                  global const float* lobe_directions, uint glossy, global const float* bright, float reach2,
                  global const float* sky_texels, SkyPicture sky, global const float4* openings, uint open,
                  global const float* densities, global const GatherPoint* points, global const float* rays,
                  uint sets, uint first, uint count, global const uint* seen, global float* results) {
    uint number = get_global_id(0);
    if (number >= count) return;
    Light source = {nodes,  light,      lobe_light, lobe_directions, bright, lit, glossy,
                    reach2, sky_texels, sky,        openings,        open,   densities + number * open};
    Place place = kept_place(nodes, points[first + number], rays, sets);
    float3 sum = (float3)(0.0f), terms[9];
    for (int k = 0; k < 9; ++k) terms[k] = (float3)(0.0f);
    uint cast = 0;
    for (int pixel = 0; pixel < PIXELS; ++pixel) {
        uint code = seen[(first + number) * (uint)(PIXELS) + (uint)(pixel)];
        if (code == kSeesNothing) continue;
        ++cast;
        float3 ray = ray_of(place, pixel);
        float3 d = place.side * ray.x + place.across * ray.y + place.axis * ray.z;
        float3 radiance = arriving(&source, &place, code, d) + arriving_by_lobes(&source, &place, code, d, ray.z);
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

// For each point: the light that it receives by what its buffer sees, by direction. For each cell of directions
// (direction_cells.h) five floats: the sum of the radiances that its rays bring, how many rays there are, and the sum of
// 1 over the distances of the slots that they meet, 1/m. Light of lobes counts there as if it came from far away: what one
// sees of it is the image of a lamp behind the surface, which stays where it is while one moves. Arguments as of shade().
kernel void sort_by_direction(global const WideNode* nodes, global const float* light, uint lit,
                              global const float* lobe_light, global const float* lobe_directions, uint glossy,
                              global const float* bright, float reach2, global const float* sky_texels, SkyPicture sky,
                              global const float4* openings, uint open, global const float* densities,
                              global const GatherPoint* points, global const float* rays, uint sets, uint first,
                              uint count, global const uint* seen, global float* results) {
    uint number = get_global_id(0);
    if (number >= count) return;
    Light source = {nodes,  light,      lobe_light, lobe_directions, bright, lit, glossy,
                    reach2, sky_texels, sky,        openings,        open,   densities + number * open};
    Place place = kept_place(nodes, points[first + number], rays, sets);
    float nearest = fmax(points[first + number].lift, 1e-6f);
    global float* cells = results + number * (5 * kDirectionCells);
    for (uint i = 0; i < 5 * kDirectionCells; ++i) cells[i] = 0.0f;
    for (int pixel = 0; pixel < PIXELS; ++pixel) {
        uint code = seen[(first + number) * (uint)(PIXELS) + (uint)(pixel)];
        if (code == kSeesNothing) continue;
        float3 ray = ray_of(place, pixel);
        float3 d = place.side * ray.x + place.across * ray.y + place.axis * ray.z;
        global float* cell = cells + 5 * direction_cell(d);
        float3 even = arriving(&source, &place, code, d), lobes = arriving_by_lobes(&source, &place, code, d, ray.z);
        vstore3(vload3(0, cell) + even + lobes, 0, cell);
        cell[3] += 1.0f;
        if (code == kSeesSky) continue;
        float share = even.x + even.y + even.z, both = share + lobes.x + lobes.y + lobes.z;
        float distance = fmax(length(slot_middle(nodes, code / 2) - place.position), nearest);
        cell[4] += (both > 0.0f ? share / both : 1.0f) / distance;
    }
}
