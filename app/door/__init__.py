"""The door: the process that listens, and hands each request to the process whose business it is.

It reads heads alone and passes bodies on as they come, so that a request for a vehicle takes no way through
the process that everybody else keeps busy. It knows no more of the service than where its two sockets are.
"""
