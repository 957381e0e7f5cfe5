#!/usr/bin/env python3
"""A server that speaks S3, for tests: moto's, with a bucket `terrain`, and one `open` that is read without credentials.

Prints its host and port, then puts the files that standard input names into both, a path and a key in each line, tabs between;
of a line `done` and a path it makes an empty file. Ends with its input.
"""
import logging
import pathlib
import sys

import boto3
from moto.server import ThreadedMotoServer

logging.getLogger("werkzeug").setLevel(logging.ERROR)
server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
server.start()
host, port = server.get_host_and_port()
client = boto3.client("s3", endpoint_url=f"http://{host}:{port}", region_name="us-east-1",
                      aws_access_key_id="testing", aws_secret_access_key="testing")
BUCKETS = {"terrain": {}, "open": {"ACL": "public-read"}}
for bucket in BUCKETS:
    client.create_bucket(Bucket=bucket)
print(f"{host}:{port}", flush=True)
for line in sys.stdin:
    path, key = line.rstrip("\n").split("\t")
    if path == "done":
        pathlib.Path(key).touch()
    else:
        for bucket, rights in BUCKETS.items():
            client.upload_file(path, bucket, key, ExtraArgs=rights)
server.stop()
