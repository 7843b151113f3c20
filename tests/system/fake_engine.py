"""An engine from another time, written from PROTOCOL.md: answers the handshake in another version."""

import socket
import threading

import programs  # noqa: F401, puts the reference client on the path
from gabion_client import HEADER, MESSAGES, VERSION, encode, frame


class FakeEngine:
    """Serves one client on a free port in a thread; answers HELLO by the frame that reply() makes."""

    def __init__(self, reply):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.socket.settimeout(20)
        self.address = "127.0.0.1:%d" % self.socket.getsockname()[1]
        self.reply = reply
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        try:
            client, _ = self.socket.accept()
        except OSError:
            return
        with client:
            client.settimeout(20)
            try:
                head = client.recv(HEADER.size, socket.MSG_WAITALL)
                if len(head) == HEADER.size:
                    client.recv(HEADER.unpack(head)[3], socket.MSG_WAITALL)
                    client.sendall(self.reply())
                    client.recv(1)  # until the coupler hangs up
            except OSError:
                pass

    def close(self):
        self.socket.close()
        self.thread.join(25)


def welcome_of_next_version():
    fields = {"protocol_version": VERSION + 1, "role": "dem", "software": "dem_server 99"}
    return frame(MESSAGES["WELCOME"]["id"], 0, 0, encode("WELCOME", fields), VERSION + 1)


def error_of_next_version():
    fields = {"code": "version", "message": f"this engine speaks version {VERSION + 1}, the client {VERSION}",
              "where": "HELLO", "advice": "use programs of the same release"}
    return frame(MESSAGES["ERROR"]["id"], 0, 0, encode("ERROR", fields))


def garbage():
    return b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
