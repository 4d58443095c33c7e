// A point that is lit, and the light that it receives.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/gbuffer.h"

struct Receiver {
    vec3 position;
    vec3 normal;
    float radius;    // of its surfel, m
    vec3 to_viewer;  // unit
    Reflectance reflectance;
};

struct Gathered {
    vec3 irradiance;  // W/m^2: free of the receiver's albedo
    vec3 specular;    // W/(sr m^2) toward the viewer by the receiver's lobe
};
