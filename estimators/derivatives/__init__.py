"""Estimators of derivatives, and walks whose lengths and collisions are kept: score functions and attached sampling."""
