# ArduPlane's simulator: the program its makers publish, on a plain Debian. No public image of theirs runs it.
#   docker build -f docker/ardupilot.Dockerfile -t swathplan-ardupilot docker
FROM debian:bookworm-slim
ADD --checksum=sha256:1b6f6810016531f81a2ab240c1353aa7310334079b4c0954ecac8d17cf1adabe --chmod=755 \
    https://firmware.ardupilot.org/Plane/stable-4.7.1/sitl/arduplane /opt/ardupilot/arduplane
ADD --checksum=sha256:93ba9a70c771609a90b81249d6a1d5a9df8d48bef7d149b42b2d9c7fbd06494a --chmod=644 \
    https://raw.githubusercontent.com/ArduPilot/ardupilot/dbe792162d06cab66c3475fd5556bf7a120f119e/Tools/autotest/models/plane.parm \
    /opt/ardupilot/plane.parm
COPY --chmod=644 ardupilot.parm /opt/ardupilot/own.parm
RUN useradd --create-home --uid 1000 simulator
USER simulator
WORKDIR /home/simulator
# Longitude and latitude of examples/sar-case-1.geojson's start.
ENV SPEEDUP=10 HOME_PLACE=33.4860851,-117.7514038,0,0 STATION=127.0.0.1:14551
CMD exec /opt/ardupilot/arduplane --synthetic-clock --wipe --model plane --speedup "$SPEEDUP" --home "$HOME_PLACE" \
    --defaults /opt/ardupilot/plane.parm,/opt/ardupilot/own.parm --serial0 "udpclient:$STATION"
