// Colours of the bands of a picture.
#include "gi/shared/luminance.h"

// Sets the colour of one band. `grey`: to its luminance.
kernel void paint_band(global float4* bands, uint band, float4 colour, uint grey) {
    if (get_global_id(0) != 0) return;
    bands[band] = grey ? (float4)((float3)(luminance(colour.xyz)), colour.w) : colour;
}
