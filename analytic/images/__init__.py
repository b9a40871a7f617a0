"""Images: the radiance along camera rays through a shape, and its mean over each pixel."""
