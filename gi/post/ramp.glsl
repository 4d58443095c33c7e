// The colours of figures.
uniform float gain;
uniform float offset;
uniform vec4 ramp[RAMP];  // sRGB

// Returns the colour of a value, as four bytes.
uint ramp_colour(float value) {
    float place = value * gain + offset;
    place = place > 0.0 ? min(place, 1.0) * float(RAMP - 1) : 0.0;  // NaN: the lower end
    uint below = min(uint(place), uint(RAMP - 2));
    return packUnorm4x8(vec4(mix(ramp[below].rgb, ramp[below + 1u].rgb, place - float(below)), 1.0));
}
float logarithm(float value) {
    return value > 0.0 ? log2(value) : -1e30;
}
