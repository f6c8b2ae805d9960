"""The border to callers: their arguments checked, and files written, the same way everywhere."""
