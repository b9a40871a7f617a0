"""What the oracle knows of each kind of camera, one module a kind, found by name. Functions of a module:

rays  (camera, x, y) -> a `Ray` for each place on the film, x to the right and y downwards in pixels from its upper left corner
same  True where every place on the film shows the same ray; it may be missing
"""
