"""Realistic errors planted in the project's own source, one at a time: do its tests see them?"""
