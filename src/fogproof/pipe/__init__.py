"""Somebody else's program, in any language, judged over a pipe or by the file it wrote; `docs/pipe.md` is the protocol.

| module      | holds                                                                  |
|-------------|------------------------------------------------------------------------|
| `process`   | a program that is started, fed, read and always ended, with its children |
| `protocol`  | the lines that say what is asked and what is answered                  |
| `blocks`    | rows of numbers as bytes or as text                                    |
| `program`   | both together: one question, one array                                 |
| `spec`      | what the user says about the program, from a TOML file                 |
| `truth`     | what the oracle says about it                                          |
| `sampler`, `estimator` | the program as fogproof's checks take it                    |
| `files`, `recorded`, `ratios` | samples that are already there                       |
| `check`     | spec and program to verdict                                            |
"""
