"""LCM's UDP multicast on a socket, as far as a robot needs it: LCM's own Python module is not in Debian. A datagram is
"LC02", a number, the channel, NUL, the message (https://lcm-proj.github.io/lcm/content/udp-multicast-protocol.html);
messages of several datagrams, such as a large map, are passed over."""
import socket
import struct

GROUP = "239.255.76.67"


class Lcm:
    def __init__(self, port):
        self.address, self.number = (GROUP, port), 0
        self.out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)  # stays on this machine
        self.inward = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.inward.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.inward.bind(self.address)
        self.inward.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + bytes(4))

    def publish(self, channel, message):  # of less than 64 kB: more takes fragments
        self.out.sendto(struct.pack(">4sI", b"LC02", self.number) + channel.encode() + b"\0" + message.encode(),
                        self.address)
        self.number += 1

    def receive(self, seconds):
        """A channel and its message; None where none of one datagram has come by then."""
        self.inward.settimeout(max(seconds, 1e-3))
        try:
            packet = self.inward.recv(65536)
        except socket.timeout:
            return None
        channel, _, message = packet[8:].partition(b"\0")
        return (channel.decode(), message) if packet[:4] == b"LC02" else ("", b"")
