// A visibility buffer (Burns and Hunt 2013, "The Visibility Buffer: A
// Cache-Friendly Approach to Deferred Shading"): of the nearest surface of
// each sample the number of its triangle, counted from 1, in the lower bits,
// and in the upper ones the row of its instance. 0 is nothing.

flat in uint visible_instance;
out uint visible_triangle;

void main() {
    visible_triangle = visible_instance | (uint(gl_PrimitiveID) + 1u);
}
