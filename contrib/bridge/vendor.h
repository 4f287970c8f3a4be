/* The three calls that a bridge needs of the library of a device's maker; replace this file by the maker's header. */
#ifndef VENDOR_H
#define VENDOR_H

typedef struct {
    double lateral_m, normal_m; /* normal: positive out of the gel, 0 at its surface */
    int button;
} VendorPosition;

int vendor_open(void);
VendorPosition vendor_get_position(void);
void vendor_set_force(double lateral_n, double normal_n);

#endif
