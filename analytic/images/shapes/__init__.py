"""What is known of shapes to the last order of scattering, as a camera outside sees them; one module a kind, found by name.

sky       (shape, medium, ray) -> radiance where a uniform sky of radiance 1 is all around, a `Reference` (n,)
parallel  (shape, medium, ray, travel) -> radiance where parallel light of irradiance 1 shines along `travel`
"""
