"""Mitsuba 3's plugins and warps; a few run with everything, the others by name: `fogproof verify mitsuba`."""
