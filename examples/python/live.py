"""Drives a sonar, records it, and maps it until Ctrl-C, along what an autopilot sends where there is one.

    live.py ping360:udp://192.168.2.2:9092 dive.bt [mavlink:udp://:14550]
"""

import sys

import pingvox

head, output, *nav = sys.argv[1:]
try:
    with pingvox.LiveMapping(head, nav=nav, record="recordings") as live:
        while live.wait(1):  # the run goes on meanwhile, in a thread of its own
            for event in live.take_events():
                print(event, flush=True)
            occupied = live.map.info()["occupied_cells"]
            print(f"{live.status.beams} beams, {occupied} occupied cells", flush=True)
except KeyboardInterrupt:
    pass
live.map.save(output)
