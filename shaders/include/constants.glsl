// Numbers that more than one shader needs.

const float PI = 3.14159265358979;
const float INVERSE_PI = 0.318309886183791;

// The largest finite value of a half-float target; what is brighter would be
// stored as infinity and become NaN where it is resolved or blended.
const float HALF_MAXIMUM = 65504.0;
