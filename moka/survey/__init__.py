"""A survey of how realistic pictures look, and what its answers mean.

The evaluation of a renderer by people: pictures of the same scenes by
several renderers are rated without knowing which made which.
``moka.survey.make`` writes a page to hand out and a key to keep,
``moka.survey.analysis`` turns answers and key into means, intervals and
tests.
"""
