"""What goes over the wire: frames, messages, mission items and their places. Knows no other room."""
