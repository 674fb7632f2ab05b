"""Tests of the lanes of cameras."""
