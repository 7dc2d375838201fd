// A vertex colour is a part of light: glTF 2.0 keeps it within 0..1, files do
// not. NaN is not greater than 0.
vec4 part_of_light(vec4 colour) {
    return mix(vec4(0.0), min(colour, 1.0), greaterThan(colour, vec4(0.0)));
}
