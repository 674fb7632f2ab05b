"""The service, the worker pool and the command line round the planner and the MAVLink link."""
