"""Hysteresis and equivalent stiffness of the head suspension under slow loading."""
