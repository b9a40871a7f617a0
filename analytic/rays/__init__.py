"""What a ray sees of a medium without scattering: transmittance, free paths, fog, emission."""
