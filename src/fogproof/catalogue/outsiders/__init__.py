"""Samplers that nobody wrote for this project, as users bring them: judged by their own pdf alone."""
