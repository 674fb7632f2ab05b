"""A simulated aircraft: its own dynamics, guidance and vehicle side of the protocol.

It shares no geometry, guidance or dialect with the planner or the encoder, so that it can disagree with them.
A fixed wing or a multirotor is simulated, behind the manners of ArduPlane, ArduCopter or PX4::

    run ── autopilot ─┬─ missions (acceptance, faults)      what it is told to fly
                      ├─ commands, parameters, telemetry    what it is told and tells
                      ├─ pilot ── executor ── manoeuvres    what it does now
                      │                └───── guidance      how it steers
                      ├─ payload                            what the sensor does
                      └─ dynamics: kinematic, jsbsim_model or multirotor, over geodesy

What it is not: it follows the polyline of its waypoints more tightly than either autopilot with default
tuning. On passes of 500 m that begin at the end of a half-turn of 100 m radius at 22.4 m/s it is off by
0.6 m (95 %), where ArduPlane's defaults were measured at 11 m; ``l1_period_s`` 20 with ``acceptance_m`` 50
gives 10 m. Fences and rally points are stored, not obeyed; the ground is flat; wind does not depend on
height; PX4's reasons for refusing a mission come as STATUSTEXT, not as EVENT. VTOLs are refused.
A multirotor keeps its lines within metres at any speed it is given, and both autopilots' spline waypoints,
regions of interest and yaw orders are not flown.
"""
