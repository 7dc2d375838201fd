// What an interface reflects, by the angle.

// Schlick 1994, equation 15, generalised to a reflectance f90 at grazing.
float fresnel_schlick(float cosine, float f0, float f90) {
    float x = 1.0 - cosine;
    float squared = x * x;
    return f0 + (f90 - f0) * (squared * squared * x);
}

vec3 fresnel_schlick(float cosine, vec3 f0, vec3 f90) {
    float x = 1.0 - cosine;
    float squared = x * x;
    return f0 + (f90 - f0) * (squared * squared * x);
}
