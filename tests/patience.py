"""How long tests wait for what will come, in seconds of the wall clock.

One limit for all: it ends what hangs, and says nothing of how fast a thing is. A busy machine with two
processors, on which a page is drawn and plans are made beside the test, has taken more than twenty seconds
for an answer that takes one.
"""

PATIENCE_S = 240.0
