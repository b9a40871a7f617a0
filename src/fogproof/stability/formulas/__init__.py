"""The formulas, a module a theme: `FORMULAS` in each is found, not listed. Truths use ball arithmetic and nothing of ours."""
