"""Trajectories among threats by mixed integer programming (Stecz and Gromada 2020, section 4.2.1)."""
