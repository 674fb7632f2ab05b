"""Forwarding of a vehicle's link to other ground stations, as MAVProxy's ``--out`` and mavlink-router do.

``address`` says where to, ``guard`` what of a station's frames may go on to the vehicle (no socket, no
clock), ``outlet`` is one address with its queue, ``hub`` joins all outlets of one vehicle with its link.
"""
