"""What no single picture shows, and the test that holds it instead."""

__all__ = ["ELSEWHERE"]

#: A claim, and the file and function of its test.
ELSEWHERE = {
    "Any joints, influences and targets, to two millionths of the size": (
        "tests/gpu/test_deformation.py::"
        "test_vertices_are_where_the_oracle_puts_them"
    ),
    "Boxes of what moves hold every vertex, so that nothing seen is culled": (
        "tests/scene/test_poses.py::"
        "test_boxes_hold_every_vertex_and_are_not_absurd"
    ),
    "Every animation of the sample models at several times, to 1e-9": (
        "tests/scene/test_real_animations.py::"
        "test_every_animation_agrees_with_the_oracle"
    ),
    "Two animations at once, blended by weight": (
        "tests/scene/test_animation_player.py::"
        "test_two_animations_blend_by_weight"
    ),
    "Pointers to lights and cameras": (
        "tests/scene/test_animation_player.py::"
        "test_lights_and_cameras_follow_pointers"
    ),
    "All channels of an animation are sampled at once": (
        "tests/scene/test_keyframes.py::test_no_channel_costs_a_call_of_its_own"
    ),
    "100 000 nodes load within a second": (
        "tests/model/test_nodes.py::test_100_000_nodes_load_within_a_second"
    ),
    "100 000 instances are one draw": (
        "tests/gpu/test_instances.py::"
        "test_a_hundred_thousand_instances_are_one_draw"
    ),
    "Levels of detail that are not shown are not decoded": (
        "tests/gpu/test_instances.py::"
        "test_only_the_level_that_is_shown_is_drawn_and_decoded"
    ),
    "A cloud of a million points": (
        "tests/gpu/test_lines_and_points.py::test_a_cloud_of_a_million_points"
    ),
    "Filters of meshoptimizer: directions, quaternions, exponents": (
        "tests/model/test_meshopt.py::test_octahedral_vectors"
    ),
    "Real models look the same compressed": (
        "tests/gpu/test_compressed_models.py::"
        "test_the_picture_is_that_of_the_original"
    ),
    "Tangents of any triangles against a brute-force MikkTSpace": (
        "tests/model/test_tangents.py::test_any_triangles_agree_with_the_oracle"
    ),
    "Specular anti-aliasing is nearer to the mean of many samples": (
        "tests/gpu/test_specular_aa.py::"
        "test_the_picture_is_nearer_to_the_mean_of_many_samples"
    ),
    "Textures keep to the largest size": (
        "tests/gpu/test_texture_sampling.py::"
        "test_textures_keep_to_the_largest_size"
    ),
    "One image for two uses is decoded once": (
        "tests/gpu/test_texture_sampling.py::"
        "test_colour_and_data_of_one_image_are_decoded_once"
    ),
    "A plain scene pays nothing for all of this": (
        "tests/gpu/test_plain_scene.py::"
        "test_a_plain_scene_pays_nothing_after_all_others"
    ),
    "moka validate agrees with Khronos's validator on every case here": (
        "tests/model/validation/test_against_khronos.py::test_on_every_feature"
    ),
}
