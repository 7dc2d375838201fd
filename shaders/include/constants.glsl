// Numbers that more than one shader needs.

const float PI = 3.14159265358979;
const float INVERSE_PI = 0.318309886183791;

// The largest finite value of a half-float target; what is brighter would be
// stored as infinity and become NaN where it is resolved or blended.
const float HALF_MAXIMUM = 65504.0;

// Brighter than anything: products with a lobe, and sums of samples and
// frames, still are finite in float32, where one infinity would be NaN after
// the next multiplication.
const float LIGHT_MAXIMUM = 1e30;

#ifdef MOKA_FLOAT_TARGET
const float RADIANCE_MAXIMUM = LIGHT_MAXIMUM;
#else
const float RADIANCE_MAXIMUM = HALF_MAXIMUM;
#endif
