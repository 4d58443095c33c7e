// What splats cover beyond the surface that is there for sure. A splat that stands for its neighbours is larger than the
// surfel, and at the edge of a surface it sticks out over it: taken whole, every outline in every map would be a texel and
// a half wider than the thing. So the core of a splat goes to the atlas, the rest here, and close.comp takes it where the
// surface goes on at both sides.
layout(std430, binding = 12) buffer Fringe { uint fringe[]; };  // as the atlas
#ifdef LUCARNE_SOURCES
layout(std430, binding = 13) buffer FringeSources { uint fringe_sources[]; };  // sources.glsl
#endif

// Radius of the core over that of the splat: at a cover of four each direction lies in one core on average.
const float kCore = 0.5;
