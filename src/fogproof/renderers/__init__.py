"""Other people's renderers, out of process: each is one file that any Python runs which has that renderer.

The contract, for a renderer of one's own too: a command with {scene}, the path of a scene as JSON with every key written out
(`fogproof.scene.to_json`), and {out}, the path of the EXR file it has to write, or {out}.npy for an array: linear radiance
[W/(m^2 sr)], row 0 the upper one, a box filter of one pixel. {samples} and {seed} may stand in it. It ends with 0, or with 1 and
why it cannot render this scene in the last line of stderr.
"""
