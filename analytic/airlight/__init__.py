"""Single scattering along a ray: the airlight integral by several methods, and every light that feeds it."""
